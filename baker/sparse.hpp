// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/bake.hpp"
#include "baker/bake_options.hpp"
#include "baker/bake_report.hpp"
#include "baker/cast.hpp"
#include "baker/hull.hpp"
#include "baker/progress.hpp"
#include "baker/stages.hpp"

namespace spm::baker {

/// Fills a `sparse` asset whose metadata tells band, probe and tolerance, and the report: tiles,
/// their proof, the choice between them and triangles, and the trees. Throws BakeError where
/// nothing of the object is left to model.
void bake_sparse(BakeResult& result, const Caster& caster, const Hull& hull,
                 const BakeOptions& options, const Progress& progress, CastCounts& counts);

}  // namespace spm::baker
