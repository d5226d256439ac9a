// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/load.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>

#include "baker/base/bake_error.hpp"
#include "baker/mesh/gunzip.hpp"
#include "baker/mesh/mesh_files.hpp"
#include "baker/mesh/mesh_reader.hpp"
#include "baker/mesh/mesh_repair.hpp"
#include "formats/files/sha256.hpp"
#include "formats/files/text_file.hpp"

namespace spm::baker {
namespace {

constexpr double kLargest = 1e9;    ///< m: beyond it fourth powers lose their meaning
constexpr double kSmallest = 1e-9;  ///< m: below it the size of a mesh is only rounding

[[noreturn]] void refuse(ExitCode code, const std::string& message) {
  throw BakeError(code, message);
}

[[nodiscard]] std::string short_text(double value) {
  std::array<char, 32> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 3);
  return {text.data(), end.ptr};
}

[[nodiscard]] std::string read_file(const std::string& path) {
  std::error_code status_error;
  const auto status = std::filesystem::status(path, status_error);
  if (std::filesystem::is_directory(status)) {
    refuse(ExitCode::file_or_device, path + ": is a directory; name a mesh file in it");
  }
  if (is_special_file(path)) {
    refuse(ExitCode::file_or_device, path + ": is a device or a pipe; give a mesh file");
  }
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             &std::fclose);
  if (!file) {
    const char* cure = errno == ENOENT   ? "check the name"
                       : errno == EACCES ? "ask for permission to read it"
                                         : "check the file and its folder";
    refuse(ExitCode::file_or_device,
           path + ": cannot open the mesh: " + std::strerror(errno) + "; " + cure);
  }
  std::string bytes;
  std::array<char, 1U << 16U> block;
  std::size_t count = 0;
  while ((count = std::fread(block.data(), 1, block.size(), file.get())) > 0) {
    bytes.append(block.data(), count);
  }
  if (std::ferror(file.get()) != 0) {
    refuse(ExitCode::file_or_device,
           path + ": cannot read the mesh: " + std::strerror(errno) + "; check the disk");
  }
  return bytes;
}

/// What a file packs; where its name and its content disagree on whether it packs anything, an
/// error.
[[nodiscard]] PolygonSoup read_unpacked(const std::string& path, const std::string& bytes,
                                        bool outside_buffers) {
  const bool named = mesh_extension(path).ends_with(".gz");
  if (named != is_gzip(bytes) && !bytes.empty()) {
    refuse(ExitCode::invalid_input,
           path + (named ? ": is named as a gzip file and is none; rename it without .gz"
                         : ": is a gzip file; rename it to end in .gz"));
  }
  return named && !bytes.empty() ? read_soup(path, gunzip(path, bytes), outside_buffers)
                                 : read_soup(path, bytes, outside_buffers);
}

/// The box of the points of triangles that have an area.
[[nodiscard]] Eigen::AlignedBox3d referenced_box(const PolygonSoup& soup) {
  Eigen::AlignedBox3d box;
  for (const auto& [a, b, c] : soup.triangles) {
    if (collinear(soup.points[a], soup.points[b], soup.points[c])) continue;
    for (const std::uint32_t corner : {a, b, c}) box.extend(soup.points[corner]);
  }
  return box;
}

void scale_points(double factor, std::vector<Vector3>& points) {
  if (factor == 1) return;
  for (Vector3& point : points) point *= factor;
}

}  // namespace

Mesh load_mesh(const std::string& path, const LoadOptions& options) {
  const std::string bytes = read_file(path);
  PolygonSoup soup = read_unpacked(path, bytes, options.outside_buffers);
  Mesh mesh;
  mesh.path = path;
  mesh.sha256 = mesh_sha256(sha256_bytes(bytes), soup.companion_digests);
  mesh.notes = std::move(soup.notes);
  mesh.open_as = options.open_as;
  mesh.unit_named = options.unit || soup.unit;
  mesh.unit = options.unit.value_or(soup.unit.value_or(1));
  scale_points(mesh.unit, soup.points);
  const Eigen::AlignedBox3d box = referenced_box(soup);
  if (box.isEmpty()) {
    refuse(ExitCode::invalid_input, path + ": none of the " +
                                        std::to_string(soup.triangles.size()) +
                                        " triangles has an area; export the mesh again");
  }
  if (options.fit_diagonal) mesh.scale = *options.fit_diagonal / box.diagonal().norm();
  if (options.scale) mesh.scale = *options.scale;
  scale_points(mesh.scale, soup.points);
  const double farthest = mesh.scale * std::max(box.min().lpNorm<Eigen::Infinity>(),
                                                box.max().lpNorm<Eigen::Infinity>());
  const double size = mesh.scale * box.diagonal().norm();
  if (!(farthest <= kLargest) || !(size >= kSmallest)) {
    refuse(
        ExitCode::invalid_input,
        path + ": the mesh is " + short_text(size) + " m in size and reaches " +
            short_text(farthest) +
            " m from the origin, outside 1e-9 to 1e9 m; give the file's --unit or --fit-diagonal");
  }
  repair(std::move(soup), mesh);
  if (mesh.triangles.empty()) {
    refuse(ExitCode::invalid_input,
           path +
               ": no triangle is left once those without area and those that cover each other are "
               "dropped; export the mesh again");
  }
  Eigen::AlignedBox3d final_box;
  for (const Vector3& vertex : mesh.vertices) final_box.extend(vertex);
  mesh.box_min = final_box.min();
  mesh.box_max = final_box.max();
  mesh.diagonal = final_box.diagonal().norm();
  return mesh;
}

}  // namespace spm::baker
