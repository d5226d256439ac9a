// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/base/progress.hpp"
#include "baker/cast/cast.hpp"
#include "baker/options/bake_options.hpp"
#include "baker/options/bake_report.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// Casts the distance maps of a `full` asset (eq. 2): one for each plane, over the plane's own
/// region. Moves each plane's x0 to the first sample of its map. Scalar or vectorial, as
/// `options.layers` says.
[[nodiscard]] std::vector<MapData> cast_full_maps(const Caster& caster,
                                                  std::vector<SupportPlane>& planes,
                                                  const BakeOptions& options,
                                                  const Progress& progress, CastCounts& counts);

}  // namespace spm::baker
