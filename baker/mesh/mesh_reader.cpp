// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/mesh_reader.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "baker/base/bake_error.hpp"
#include "baker/mesh/loop_span.hpp"
#include "baker/mesh/mesh_files.hpp"
#include "baker/mesh/mesh_text.hpp"

namespace spm::baker {
namespace {

struct Format {
  std::string_view name;
  std::string_view extension;
  PolygonSoup (*read)(const std::string& path, std::string_view bytes);  ///< none: by read_gltf
  bool (*resembles)(std::string_view bytes);
};

[[nodiscard]] std::string_view first_word(std::string_view bytes) {
  constexpr std::string_view kBlank = " \t\r\n\v\f";
  const std::size_t begin = std::min(bytes.find_first_not_of(kBlank), bytes.size());
  return bytes.substr(begin, bytes.find_first_of(kBlank, begin) - begin);
}

[[nodiscard]] bool resembles_stl(std::string_view bytes) {
  constexpr std::size_t kLongName = 1024;
  return is_binary_stl(bytes) ||
         (lower_case(first_word(bytes)) == "solid" &&
          lower_case(bytes.substr(0, kLongName)).find("facet") != std::string::npos);
}

[[nodiscard]] bool resembles_ply(std::string_view bytes) { return first_word(bytes) == "ply"; }

[[nodiscard]] bool resembles_off(std::string_view bytes) {
  return first_word(bytes).ends_with("OFF") && first_word(bytes).size() <= 8;
}

/// OBJ has no signature. It counts as OBJ where a line begins a vertex or a face and there is no
/// binary data.
[[nodiscard]] bool resembles_obj(std::string_view bytes) {
  if (bytes.find('\0') != std::string_view::npos) return false;
  for (const std::string_view start : {"\nv ", "\nv\t", "\rv ", "\nf "}) {
    if (bytes.starts_with(start.substr(1)) || bytes.find(start) != std::string_view::npos) {
      return true;
    }
  }
  return false;
}

constexpr std::array<Format, 7> kFormats{{{"GLB", ".glb", nullptr, is_glb},
                                          {"3MF", ".3mf", read_3mf, resembles_3mf},
                                          {"STL", ".stl", read_stl, resembles_stl},
                                          {"PLY", ".ply", read_ply, resembles_ply},
                                          {"OFF", ".off", read_off, resembles_off},
                                          {"glTF", ".gltf", nullptr, resembles_gltf},
                                          {"OBJ", ".obj", read_obj, resembles_obj}}};

[[nodiscard]] const Format* format_of_extension(const std::string& extension) {
  const auto* found = std::find_if(kFormats.begin(), kFormats.end(),
                                   [&](const Format& f) { return f.extension == extension; });
  return found == kFormats.end() ? nullptr : found;
}

[[nodiscard]] const Format* format_of_content(std::string_view bytes) {
  const auto* found = std::find_if(kFormats.begin(), kFormats.end(),
                                   [&](const Format& f) { return f.resembles(bytes); });
  return found == kFormats.end() ? nullptr : found;
}

[[nodiscard]] const Format& choose_format(const std::string& path, std::string_view bytes) {
  const std::string extension = unpacked_extension(path);
  const Format* named = format_of_extension(extension);
  const Format* seen = format_of_content(bytes);
  if (named == nullptr && seen == nullptr) {
    refuse_file(path, "neither its extension nor its content is that of a mesh",
                "give a glTF, 3MF, OBJ, PLY, STL or OFF file");
  }
  if (named == nullptr) {
    refuse_file(path,
                "the extension '" + extension + "' is not that of a mesh, but the content looks " +
                    "like " + std::string(seen->name),
                "rename the file to end in " + std::string(seen->extension));
  }
  if (seen != nullptr && seen != named) {
    refuse_file(path,
                "the extension says " + std::string(named->name) + ", but the content looks like " +
                    std::string(seen->name),
                "rename the file to end in " + std::string(seen->extension));
  }
  return *named;
}

/// Spans polygons anew whose fans fold, as a notch makes them do: by the triangles of the least
/// area.
void unfold_polygons(PolygonSoup& soup) {
  const auto twice_area = [&](const Triangle& t) -> Vector3 {
    return (soup.points[t[1]] - soup.points[t[0]]).cross(soup.points[t[2]] - soup.points[t[0]]);
  };
  for (const auto& [first, count] : soup.polygons) {
    const std::span<Triangle> fan = std::span(soup.triangles).subspan(first, count);
    Vector3 up = Vector3::Zero();
    for (const Triangle& triangle : fan) up += twice_area(triangle);
    if (std::none_of(fan.begin(), fan.end(),
                     [&](const Triangle& triangle) { return twice_area(triangle).dot(up) < 0; })) {
      continue;
    }
    Loop loop{fan.front()[0], fan.front()[1]};
    for (const Triangle& triangle : fan) loop.push_back(triangle[2]);
    std::vector<Triangle> spanned;
    span_loop(soup.points, loop, spanned);
    std::copy(spanned.begin(), spanned.end(), fan.begin());
  }
}

}  // namespace

void refuse_file(const std::string& place, const std::string& cause, const std::string& cure) {
  throw BakeError(ExitCode::invalid_input, place + ": " + cause + "; " + cure);
}

void add_polygon(std::span<const std::uint32_t> polygon, PolygonSoup& soup) {
  if (polygon.size() > 3) soup.polygons.emplace_back(soup.triangles.size(), polygon.size() - 2);
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    soup.triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
  }
}

PolygonSoup read_soup(const std::string& path, std::string_view bytes, bool outside_buffers) {
  if (bytes.empty()) refuse_file(path, "the file is empty");
  std::string text;
  if (is_utf16(bytes) && unpacked_extension(path) == ".obj") {
    bytes = text = ascii_of_utf16(path, bytes);
  }
  const Format& format = choose_format(path, bytes);
  PolygonSoup soup =
      format.read != nullptr ? format.read(path, bytes) : read_gltf(path, bytes, outside_buffers);
  if (soup.triangles.empty()) {
    refuse_file(path,
                "the file holds " + std::to_string(soup.points.size()) + " vertices and no face",
                "export the mesh with its faces, a point cloud cannot be baked");
  }
  unfold_polygons(soup);
  return soup;
}

}  // namespace spm::baker
