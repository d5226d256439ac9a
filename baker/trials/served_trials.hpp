// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "baker/cast/cast.hpp"
#include "baker/options/bake_report.hpp"
#include "common/asset/asset_view.hpp"

namespace spm::baker {

/// Queries places all over the band, as whoever opens the file does, and compares with the surface.
/// `view` is the asset with all that opening derives. Places that were pruned are left out, and
/// places nearer to a cap than to the surface, where nothing is promised.
[[nodiscard]] ServedTrials try_served(const AssetView& view, const Caster& caster,
                                      std::uint64_t seed);

}  // namespace spm::baker
