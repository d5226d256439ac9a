// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "baker/mesh/fan_angles.hpp"
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
    Vector3 low, high, apex;
    std::uint32_t first = 0, last = 0;                      ///< triangles
    std::uint32_t edges = 0;                                ///< of the boundary
    std::uint32_t first_block = 0, last_block = 0;          ///< they, directed
    std::uint32_t first_triangles = 0, last_triangles = 0;  ///< of a leaf, in blocks
    std::int32_t left = -1, right = -1;
  };

  /// A tree over some of the triangles, its root first.
  struct Tree {
    std::vector<Node> nodes;
    std::vector<EdgeBlock> blocks;  ///< of all nodes
    std::vector<TriangleBlock> leaves;

    std::int32_t append(const Tree& other);  ///< gives where its root comes to be
  };
  class Builder;

  Tree tree_;
};

}  // namespace spm::baker
