// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/pictures/export.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstdint>
#include <iterator>

namespace spm::baker {
namespace {

template <class T>
void append_bytes(std::string& bytes, T value) {
  static_assert(std::endian::native == std::endian::little);
  const auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  bytes.append(raw.data(), raw.size());
}

}  // namespace

std::string to_ply(const ContourMesh& surface, bool text) {
  std::string ply = fmt::format(
      "ply\nformat {} 1.0\ncomment the surface as a baked asset knows it, metres\n"
      "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      text ? "ascii" : "binary_little_endian", surface.vertices.size(),
      surface.triangles.size() / 3);
  for (const auto& [x, y, z] : surface.vertices) {
    if (text) {
      fmt::format_to(std::back_inserter(ply), "{} {} {}\n", x, y, z);
    } else {
      for (const float value : {x, y, z}) append_bytes(ply, value);
    }
  }
  for (std::size_t i = 0; i + 2 < surface.triangles.size(); i += 3) {
    const std::array corners{surface.triangles[i], surface.triangles[i + 1],
                             surface.triangles[i + 2]};
    if (text) {
      fmt::format_to(std::back_inserter(ply), "3 {} {} {}\n", corners[0], corners[1], corners[2]);
    } else {
      append_bytes(ply, static_cast<std::uint8_t>(3));
      for (const std::uint32_t corner : corners)
        append_bytes(ply, static_cast<std::int32_t>(corner));
    }
  }
  return ply;
}

}  // namespace spm::baker
