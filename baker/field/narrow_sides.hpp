// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "baker/field/triangle_sides.hpp"
#include "baker/surface/outer_surface.hpp"
#include "common/field/feature_sides.hpp"

namespace spm::baker {

/// Leaves to crossings what a side tells, where narrow triangles lead to another that tells another
/// thing: near the corner at which both end, single precision takes one for the other. `sides` are
/// those of each triangle (find_feature_sides).
void cross_beside_narrow(const OuterSurface& surface, const TriangleSides& uses,
                         std::span<FeatureSides> sides);

}  // namespace spm::baker
