// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "baker/field/cube_candidates.hpp"
#include "baker/reachability/reachability.hpp"
#include "common/field/distance_octree.hpp"

namespace spm::baker {

/// A cluster of a list is the nearest triangle of it away from the cube by at least this.
struct ListedCandidate {
  std::uint32_t triangle = 0;
  double bound = 0;  ///< m: it is at least this far from every point of the cube
};

/// A cube of the distance octree while it is built.
struct OctreeNode {
  OctreeKind kind = OctreeKind::far;
  Cube cube;
  std::vector<std::uint32_t> words;        ///< of polynomials and of deep cubes
  double clearance = 0;                    ///< of a far one's middle, m
  std::vector<ListedCandidate> triangles;  ///< of a list, without caps
  std::vector<ListedCandidate> caps;       ///< of a list
  ListSide side = ListSide::surface;       ///< of a list
  PruneRule rule = PruneRule::none;        ///< of a pruned cube
  std::unique_ptr<std::array<OctreeNode, 8>> octants;
};

}  // namespace spm::baker
