// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/cast/cast.hpp"
#include "baker/surface/outer_surface.hpp"
#include "common/field/feature_sides.hpp"

namespace spm::baker {

/// For each triangle of a surface, caps included, on which side places lie that are nearest to one
/// of its parts. Exact where the surface is closed; sheets that only touch may do so in any way.
/// `folded` is what find_folded says of the triangles. `solid` decides where triangles lie on each
/// other or do not close, and so tell nothing, for places `tolerance` metres away, or less where
/// something else is nearer there.
[[nodiscard]] std::vector<FeatureSides> find_feature_sides(const OuterSurface& surface,
                                                           const std::vector<bool>& folded,
                                                           const Caster& solid, double tolerance);

/// For each triangle of a surface whether another one lies on it and faces the other way.
[[nodiscard]] std::vector<bool> find_folded(const std::vector<Triangle>& triangles);

}  // namespace spm::baker
