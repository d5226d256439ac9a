// SPDX-License-Identifier: Apache-2.0
#include "common/asset/sign_octree.hpp"

namespace spm {

namespace {

/// The cube of a query.
struct Asked {
  Vector3 low, high;
};

/// The kinds of a node's octants that a cube touches.
unsigned signs_below(const SignOctree& tree, std::size_t node, const Vector3& low, double edge,
                     const Asked& cube, int level) noexcept {
  if ((node + 1) * sign_octree_node_words > tree.words.size() || level == sign_octree_levels) {
    return sign_bit(SignKind::far);
  }
  const std::uint32_t kinds = tree.words[node * sign_octree_node_words];
  unsigned found = 0;
  for (std::uint32_t octant = 0; octant < 8; ++octant) {
    Vector3 corner = low;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (is_upper(octant, axis)) corner[static_cast<int>(axis)] += edge / 2;
    }
    if ((corner.array() > cube.high.array()).any() ||
        ((corner.array() + edge / 2) < cube.low.array()).any()) {
      continue;
    }
    const SignKind kind = octant_kind(kinds, octant);
    if (kind != SignKind::split) {
      found |= sign_bit(kind);
      continue;
    }
    const std::size_t child =
        std::size_t{tree.words[node * sign_octree_node_words + 1]} + splits_below(kinds, octant);
    found |= signs_below(tree, child, corner, edge / 2, cube, level + 1);
  }
  return found;
}

}  // namespace

unsigned signs_of_cube(const SignOctree& tree, const Vector3& middle, double half) noexcept {
  const Asked cube{middle - Vector3::Constant(half), middle + Vector3::Constant(half)};
  const bool reaches_out = (cube.low.array() < tree.origin.array()).any() ||
                           (cube.high.array() > tree.origin.array() + tree.edge).any();
  return (reaches_out ? sign_bit(SignKind::far) : 0U) |
         signs_below(tree, 0, tree.origin, tree.edge, cube, 0);
}

}  // namespace spm
