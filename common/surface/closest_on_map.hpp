// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/surface/distance_map.hpp"

namespace spm {

/// Closest point on a map's height field to a given point.
struct MapClosestPoint {
  bool valid =
      false;  ///< the closest point lies in a cell that the mask allows, so it is a surface point
  double distance = 0;  ///< signed, m: negative on the far side of the surface, seen from the
                        ///< plane; not finite where the cell has a sample without a hit
  double rank =
      0;  ///< of several closest points the one with the lowest rank is used; see closest_on_map
  MapCell cell;  ///< where the closest point is
};

/// Newton steps towards the closest point; bounded, so that the time of a tick is bounded.
inline constexpr int closest_point_steps = 3;

/// Closest point on one layer of a map to `point` (object's frame, m). Up to `closest_point_steps`
/// times, the height field is replaced by its tangent plane (eq. 7, 8) at the current estimate, and
/// the point is projected on that plane. An estimate beyond the map's border is clamped to the
/// border. It is still a point of the surface, so its distance is never less than the true one.
///
/// The rank is the absolute distance where the closest point is valid. In a masked cell a tenth of
/// a spacing is added, so that such a point is used only where every valid one is clearly farther
/// away, as in a gap between valid cells. Where a masked cell is as steep as a silhouette, so much
/// is added that its point is used last.
[[nodiscard]] MapClosestPoint closest_on_map(const DistanceMap& map, std::uint32_t layer,
                                             const SupportPlane& plane,
                                             const Vector3& point) noexcept;

/// Unit normal at a closest point, towards the plane's side (eq. 5), continuous across the borders
/// of valid cells. Not finite where a sample around it has no hit.
[[nodiscard]] Vector3 normal_at(const DistanceMap& map, std::uint32_t layer,
                                const SupportPlane& plane, const MapCell& cell) noexcept;

}  // namespace spm
