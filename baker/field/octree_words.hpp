// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/charts/atlas.hpp"
#include "baker/field/octree_build.hpp"
#include "baker/field/octree_pruning.hpp"

namespace spm::baker {

/// Writes octree, lists and the triangles that these use in the words that the file stores.
void write_words(const OctreeRoots& roots, const LatticeSurface& surface, const Atlas& atlas,
                 BuiltOctree& built);

}  // namespace spm::baker
