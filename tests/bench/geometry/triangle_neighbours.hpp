// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "tests/bench/geometry/nearest_point.hpp"
#include "tests/bench/model/float_mesh.hpp"

namespace spm::bench {

/// Which triangles touch each vertex: the side of a solid, for searches that name one nearest
/// triangle where several meet.
class TriangleNeighbours {
 public:
  explicit TriangleNeighbours(const FloatMesh& mesh);

  /// A word a vertex, and one a corner of a triangle.
  [[nodiscard]] std::uint64_t bytes() const noexcept {
    return 4 * (first_.size() + triangles_.size());
  }

  /// Answer at a point whose nearest triangle, or one of several, is `triangle`; where its closest
  /// point lies on an edge or a corner, of all that touch it. `tie` in metres.
  [[nodiscard]] Answer answer(const FloatMesh& mesh, const Vector3& point, std::uint32_t triangle,
                              double tie) const noexcept;

 private:
  std::vector<std::uint32_t> first_;      ///< a vertex's first place in triangles_, and an end
  std::vector<std::uint32_t> triangles_;  ///< by vertex
};

}  // namespace spm::bench
