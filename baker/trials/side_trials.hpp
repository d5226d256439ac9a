// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "baker/trees/space_build.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// What trials of a `sparse` asset came to.
struct SideTrials {
  std::uint64_t mended = 0;          ///< places where cubes were divided for the side
  std::uint64_t wrong = 0;           ///< trials of the last pass that no division mended
  std::uint64_t cells = 0;           ///< cubes that touch the band
  std::uint64_t fallback_cells = 0;  ///< of them, those whose middle is nearest to a triangle
};

/// Tries the side that an asset tells at places all over the band and near edges, against the
/// surface's own; where it is wrong farther than the tolerance from the surface, has the cubes of
/// space divided down to one that lies on one side, and looks closer around the place. Fills the
/// asset's space.
[[nodiscard]] SideTrials try_sides(Asset& asset, const Caster& caster, SpaceBuilder& space,
                                   const Progress& progress);

}  // namespace spm::baker
