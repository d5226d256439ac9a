// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/base/octant.hpp"
#include "common/field/distance_octree.hpp"

namespace spm {

namespace octree_leaves {

template <class Visit>
void below(const DistanceOctree& octree, const Leaf& cube, const Visit& visit) {
  const std::uint32_t* words = words_at(octree, cube);
  if (cube.kind != OctreeKind::split) {
    visit(cube);
    return;
  }
  if (words == nullptr || cube.level == max_octree_levels) return;
  for (std::uint32_t octant = 0; octant < 8; ++octant) {
    Leaf part;
    part.kind = static_cast<OctreeKind>((words[1] >> (4 * octant)) & 15U);
    part.word = words[0] + words_before(words[1], octant);
    part.level = cube.level + 1;
    part.half = cube.half / 2;
    part.middle = cube.middle + part.half * octant_direction(octant);
    below(octree, part, visit);
  }
}

}  // namespace octree_leaves

/// Calls `visit` with each leaf, in the order of the words. Of an octree that was checked.
template <class Visit>
void visit_leaves(const DistanceOctree& octree, const Visit& visit) {
  std::size_t place = 0;
  for (std::uint32_t z = 0; z < octree.roots[2]; ++z) {
    for (std::uint32_t y = 0; y < octree.roots[1]; ++y) {
      for (std::uint32_t x = 0; x < octree.roots[0]; ++x, ++place) {
        const std::optional<OctreeRoot> known = root_at(octree, place);
        if (!known) return;
        Leaf root;
        root.kind = known->kind;
        root.word = known->word;
        root.level = 0;
        root.half = octree.edge / 2;
        root.middle = octree.origin + octree.edge * (Vector3(x, y, z) + Vector3::Constant(0.5));
        octree_leaves::below(octree, root, visit);
      }
    }
  }
}

}  // namespace spm
