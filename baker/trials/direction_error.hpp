// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/cast/cast.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// The median error of an asset's directions, rad. It is measured at places of the band where the
/// surface is nearest in one direction only. The asset must have its BVH and its sign octree. 0
/// where no place can be tried.
[[nodiscard]] double median_direction_error(const Asset& asset, const Caster& caster,
                                            std::uint64_t seed);

}  // namespace spm::baker
