// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "baker/mesh/mesh.hpp"
#include "common/base/vector.hpp"

namespace spm::baker {

/// Generalised winding number of triangles, exact up to rounding: 1 inside one closed part whose
/// normals point out, 2 where two parts overlap, 0 outside, in between near holes. Seen from
/// outside its box, a cluster of triangles has the solid angle of any surface with the same
/// boundary. So a fan over its boundary edges replaces it (Jacobson et al. 2013, section 4.2).
class WindingNumber {
 public:
  /// Copies what it needs. Indices must be in range. Degenerate triangles add nothing.
  WindingNumber(std::span<const Vector3> vertices, std::span<const Triangle> triangles);

  /// Any point in metres; on the surface it takes a value between those of the sides. Thread-safe
  /// and deterministic.
  [[nodiscard]] double at(const Vector3& point) const noexcept;

 private:
  using Edge = std::array<std::uint32_t, 2>;

  struct Node {
    Eigen::AlignedBox3d box;
    std::uint32_t first = 0, last = 0;            ///< triangles
    std::uint32_t first_edge = 0, last_edge = 0;  ///< of the boundary
    std::int32_t left = -1, right = -1;           ///< -1: a leaf
  };

  std::vector<Node> nodes_;                         ///< the root first
  std::vector<std::array<Vector3, 3>> triangles_;   ///< those of a node follow each other
  std::vector<std::array<Vector3, 2>> boundaries_;  ///< directed, of all nodes

  /// Adds the tree over the triangles of some numbers, which it puts in order; gives the place of
  /// its root, and the edges of its boundary.
  std::int32_t add(std::span<const Vector3> vertices, std::span<Triangle> triangles,
                   std::uint32_t first, std::vector<Edge>& boundary);
};

}  // namespace spm::baker
