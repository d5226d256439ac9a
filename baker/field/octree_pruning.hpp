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

/// Bytes of the octree's words and maps as it is, without what make_lists would make of it.
[[nodiscard]] double bytes_as_divided(const OctreeRoots& roots);

/// Which triangles lists have, those that were found too, or no tile shows.
[[nodiscard]] std::vector<bool> used_triangles(const LatticeSurface& surface,
                                               const OctreeRoots& roots);

/// Bytes of the exact triangles, with the lists that were found.
[[nodiscard]] double triangle_bytes(const LatticeSurface& surface, const OctreeRoots& roots);

/// Of these, what the heights of its maps are reckoned with, without cubes that were found lists.
[[nodiscard]] double shared_bytes(const OctreeRoots& roots);

/// Finds the split cubes that are better lists so that the fewest bytes are left, and returns
/// these.
[[nodiscard]] double find_least_bytes(OctreeRoots& roots);

/// Finds the split cubes that are better lists so that answers take the least time, in the mean
/// over the band, of all octrees of so many bytes, or nearly so. Returns their bytes.
double find_fastest(double bytes, OctreeRoots& roots);

/// Joins eight roots in one, again and again, at most so often, while that saves bytes; returns how
/// often. `make_root` makes those that the grid lacks.
[[nodiscard]] int join_roots(int most, const RootMaker& make_root, OctreeRoots& roots);

/// Parts each root into eight, where the octree takes hardly more bytes by that; returns whether.
/// `make_root` makes those of a root that is not divided.
[[nodiscard]] bool part_roots(const RootMaker& make_root, OctreeRoots& roots);

/// Makes the cubes that were found lists.
void make_lists(const LatticeSurface& surface, OctreeRoots& roots);

}  // namespace spm::baker
