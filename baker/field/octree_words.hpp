// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/field/octree_build.hpp"
#include "baker/field/octree_node.hpp"

namespace spm::baker {

/// Groups the triangles that the lists use into clusters, and writes octree, lists and clusters in
/// the words that the file stores.
void write_words(const std::vector<OctreeNode>& roots, const LatticeSurface& surface,
                 BuiltOctree& built);

}  // namespace spm::baker
