// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "tests/bench/geometry/nearest_point.hpp"
#include "tests/bench/model/float_mesh.hpp"

namespace spm::bench {

/// Lists the triangles at each vertex. This gives the side of a solid to searches that return only
/// one nearest triangle where several meet.
class TriangleNeighbours {
 public:
  explicit TriangleNeighbours(const FloatMesh& mesh);

  /// One word per vertex, and one per corner of a triangle.
  [[nodiscard]] std::uint64_t bytes() const noexcept {
    return 4 * (first_.size() + triangles_.size());
  }

  /// Answer at a point whose nearest triangle, or one of several, is `triangle`. If the closest
  /// point lies on an edge or a corner, all neighbours are considered. `tie` in metres.
  [[nodiscard]] Answer answer(const FloatMesh& mesh, const Vector3& point, std::uint32_t triangle,
                              double tie) const noexcept;

 private:
  std::vector<std::uint32_t> first_;      ///< first index into triangles_ per vertex, and the end
  std::vector<std::uint32_t> triangles_;  ///< grouped by vertex
};

}  // namespace spm::bench
