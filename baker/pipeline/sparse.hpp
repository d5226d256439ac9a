// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/base/progress.hpp"
#include "baker/cast/cast.hpp"
#include "baker/options/bake_options.hpp"
#include "baker/options/bake_report.hpp"
#include "baker/pipeline/bake.hpp"
#include "baker/planes/hull.hpp"

namespace spm::baker {

/// Fills a `sparse` asset and the report: distance maps, and the octree that answers, which is
/// proven. The asset's metadata must have band, probe and tolerance. Throws
/// BakeError where nothing of the object is left to model.
void bake_sparse(BakeResult& result, const OuterSurface& surface, const Caster& caster,
                 const Hull& hull, const BakeOptions& options, const Progress& progress,
                 CastCounts& counts);

}  // namespace spm::baker
