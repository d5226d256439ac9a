// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "baker/field/lattice_surface.hpp"
#include "baker/field/octree_node.hpp"

namespace spm::baker {

/// A grid of roots, x fastest.
struct OctreeRoots {
  std::array<std::uint32_t, 3> count{0, 0, 0};
  std::vector<OctreeNode> nodes;
};

/// Makes the root of a cube.
using RootMaker = std::function<OctreeNode(const Cube&)>;

/// Which triangles lists have, those that were found too, or no tile shows.
[[nodiscard]] std::vector<bool> used_triangles(const LatticeSurface& surface,
                                               const OctreeRoots& roots);

/// Bytes of the exact triangles, with the lists that were found.
[[nodiscard]] double triangle_bytes(const LatticeSurface& surface, const OctreeRoots& roots);

/// What the heights of its maps are reckoned with, in bytes, without cubes that were found lists.
[[nodiscard]] double shared_bytes(const OctreeRoots& roots);

/// Finds the split cubes that are better lists so that the fewest bytes are left, and returns
/// these.
[[nodiscard]] double find_least_bytes(OctreeRoots& roots);

/// Finds the split cubes that are better lists so that answers take the least time, in the mean
/// over the band, of all octrees of so many bytes, or nearly so. Returns their bytes.
double find_fastest(double bytes, OctreeRoots& roots);

/// Finds the split cubes that are better lists, and parts each root into eight again and again, at
/// most so often, so that bytes times the time of answers is least; returns how often. Maps stay.
/// `make_root` makes those of a root that is not divided.
[[nodiscard]] int find_best(const LatticeSurface& surface, int most, const RootMaker& make_root,
                            OctreeRoots& roots);

/// Makes the cubes that were found lists.
void make_lists(const LatticeSurface& surface, OctreeRoots& roots);

}  // namespace spm::baker
