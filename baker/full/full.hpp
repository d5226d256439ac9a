// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/base/progress.hpp"
#include "baker/cast/cast.hpp"
#include "baker/options/bake_options.hpp"
#include "baker/options/bake_report.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// Distance maps of a `full` asset, one a plane over the plane's own region; moves each plane's x0
/// to its map's first sample. Scalar or vectorial as `options.layers` says.
[[nodiscard]] std::vector<MapData> cast_full_maps(const Caster& caster,
                                                  std::vector<SupportPlane>& planes,
                                                  const BakeOptions& options,
                                                  const Progress& progress, CastCounts& counts);

}  // namespace spm::baker
