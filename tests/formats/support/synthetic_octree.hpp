// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/base/random.hpp"
#include "formats/asset/asset.hpp"

namespace spm::test {

/// An octree of random content that is consistent, with cubes of all kinds, and this
/// many triangles, the last quarter of which are of sheets. Its polynomials are in the frames of so
/// many planes; where there are none, or no triangles, what needs them is left out.
[[nodiscard]] OctreeData random_octree(Random& random, std::uint32_t planes,
                                       std::uint32_t triangles);

}  // namespace spm::test
