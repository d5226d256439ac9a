// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "baker/mesh/mesh.hpp"

namespace spm::baker {

/// A mesh as its file has it, in the file's unit. Points may repeat and triangles may be
/// degenerate, but coordinates are finite and indices are in range.
struct PolygonSoup {
  std::vector<Vector3> points;
  std::vector<Triangle> triangles;
  std::vector<std::string> companion_digests;  ///< of other files that it was read from
  std::optional<double> unit;                  ///< metres, where the file says it
  std::vector<std::string> notes;              ///< what was left out, a sentence each
  /// The first triangle of each polygon of more than three corners, and how many it has.
  std::vector<std::pair<std::size_t, std::size_t>> polygons = {};
};

/// The most vertices that a file may place, and the most triangles: many parts of it may name the
/// same few bytes.
inline constexpr std::size_t most_points = std::size_t{1} << 25U;

/// A mesh packs by a factor of 3 to 20. What unpacks to more than so many times as many bytes, and
/// to more bytes than these, is none.
inline constexpr std::size_t most_growth = 100, always_unpacked = std::size_t{64} << 20U;

/// Throws BakeError invalid_input: "place: cause; cure".
[[noreturn]] void refuse_file(const std::string& place, const std::string& cause,
                              const std::string& cure = "export the mesh again");

/// Fans a polygon from its first vertex. Where that is no good is seen when all points are known.
void add_polygon(std::span<const std::uint32_t> polygon, PolygonSoup& soup);

/// Reads the unpacked bytes of a mesh file in the format on which its extension and its content
/// agree. These are our own readers, since CGAL's accept cut, non-finite and out-of-range input,
/// and name no line. `outside_buffers`: as of LoadOptions. Throws BakeError invalid_input, which
/// names file, place, cause and what to do.
[[nodiscard]] PolygonSoup read_soup(const std::string& path, std::string_view bytes,
                                    bool outside_buffers = false);

[[nodiscard]] PolygonSoup read_3mf(const std::string& path, std::string_view bytes);
[[nodiscard]] PolygonSoup read_obj(const std::string& path, std::string_view bytes);
/// Buffers may be in the file, in its text, or in regular files in its folder or below;
/// `outside_buffers`: elsewhere too. Throws BakeError: file_or_device for a buffer that cannot be
/// read; invalid_input, also for more than 4 GiB of buffers.
[[nodiscard]] PolygonSoup read_gltf(const std::string& path, std::string_view bytes,
                                    bool outside_buffers);
[[nodiscard]] PolygonSoup read_off(const std::string& path, std::string_view bytes);
[[nodiscard]] PolygonSoup read_ply(const std::string& path, std::string_view bytes);
[[nodiscard]] PolygonSoup read_stl(const std::string& path, std::string_view bytes);

/// The files with buffers that a glTF names. Throws BakeError invalid_input.
[[nodiscard]] std::vector<std::string> gltf_companions(const std::string& path,
                                                       std::string_view bytes,
                                                       bool outside_buffers);

/// Whether bytes are those of a `.glb`, and whether they look like a `.gltf`.
[[nodiscard]] bool is_glb(std::string_view bytes);
[[nodiscard]] bool resembles_gltf(std::string_view bytes);

/// True where the bytes are a package of 3MF, by the names of its parts.
[[nodiscard]] bool resembles_3mf(std::string_view bytes);

/// True where the bytes are a binary STL, by the count of triangles in them.
[[nodiscard]] bool is_binary_stl(std::string_view bytes);

}  // namespace spm::baker
