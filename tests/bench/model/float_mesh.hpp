// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "baker/surface/outer_surface.hpp"
#include "common/base/vector.hpp"

namespace spm::bench {

/// An indexed mesh in single precision: what a method that keeps the triangles has to keep.
struct FloatMesh {
  std::vector<std::array<float, 3>> vertices;  ///< m
  std::vector<std::array<std::uint32_t, 3>> triangles;

  /// The triangles of an outer surface without its caps, and the vertices they use.
  explicit FloatMesh(const baker::OuterSurface& surface);

  /// Three floats per vertex and three 32-bit numbers per triangle.
  [[nodiscard]] static constexpr std::uint64_t bytes_of(std::uint64_t vertices,
                                                        std::uint64_t triangles) noexcept {
    return 12 * (vertices + triangles);
  }
  [[nodiscard]] std::uint64_t bytes() const noexcept {
    return bytes_of(vertices.size(), triangles.size());
  }

  [[nodiscard]] std::array<Vector3, 3> corners(std::uint32_t triangle) const noexcept {
    std::array<Vector3, 3> result;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::array<float, 3>& vertex = vertices[triangles[triangle][i]];
      result[i] = Vector3(vertex[0], vertex[1], vertex[2]);
    }
    return result;
  }
};

}  // namespace spm::bench
