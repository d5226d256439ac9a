// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/asset/asset_view.hpp"
#include "common/index/packet_bounds.hpp"
#include "common/query/closest_element.hpp"

namespace spm {

/// What is known of the distances of a cube's points to the surface, by the closest point of its
/// middle: that closest point, or the triangle it is on; and the surface about it, where that is
/// smooth. `half` of the cube's edge, m. For the loading thread.
[[nodiscard]] SurfaceCube surface_cube(const AssetView& asset, const Vector3& middle, double half,
                                       const ElementClosestPoint& nearest);

}  // namespace spm
