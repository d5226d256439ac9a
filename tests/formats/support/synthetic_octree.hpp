// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/base/random.hpp"
#include "formats/asset/asset.hpp"

namespace spm::test {

/// An octree of random content that is consistent, with cubes of all kinds, and this many
/// triangles, the last quarter of which are of sheets. Its cubes of maps name one or two of so many
/// charts; where there are none, or no triangles, what needs them is left out.
[[nodiscard]] OctreeData random_octree(Random& random, std::uint32_t charts,
                                       std::uint32_t triangles);

/// So many charts side by side, of random planes and heights, some of an offset surface; none where
/// there are no planes.
[[nodiscard]] AtlasData random_atlas(Random& random, std::uint32_t planes, std::uint32_t charts);

}  // namespace spm::test
