// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "baker/trees/sign_octree_build.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// Results of the trials of a `sparse` asset.
struct SideTrials {
  std::uint64_t resolved = 0;        ///< places where cubes were divided for the side
  std::uint64_t wrong = 0;           ///< trials of the last pass that no division resolved
  std::uint64_t cells = 0;           ///< cubes that touch the band
  std::uint64_t fallback_cells = 0;  ///< those of them whose middle is nearest to a triangle
};

/// Compares the side that an asset gives with the true one, at places all over the band and near
/// edges. Where it is wrong and farther than the tolerance from the surface, the cubes of the sign
/// octree are divided down to one that lies on one side, and more places are tried around it. Fills
/// the asset's space.
[[nodiscard]] SideTrials try_sides(Asset& asset, const Caster& caster,
                                   SignOctreeBuilder& sign_octree, const Progress& progress);

}  // namespace spm::baker
