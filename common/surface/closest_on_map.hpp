// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/surface/distance_map.hpp"

namespace spm {

/// Closest point of a map's height field, found from a point.
struct MapFoot {
  bool valid = false;   ///< the foot lies in a cell that the mask allows, so it is a surface point
  double distance = 0;  ///< signed, m: negative on the far side of the surface from the plane; not
                        ///< finite where the foot's cell has a sample without hit
  double rank = 0;      ///< of several feet the one with the least rank answers; see closest_on_map
  MapCell cell;         ///< where the foot is
};

/// Newton steps towards the foot; bounded so that the tick is.
inline constexpr int foot_steps = 3;

/// Closest point on one layer of a map to `point` (object's frame, m): the field is replaced by its
/// tangent plane (eq. 7, 8) at the current foot, and the point projected on it, at most
/// `foot_steps` times. Feet beyond the map's border are clamped to it: still points of the surface,
/// so that their distance is never less than the true one.
/// The rank is the size of the distance where the foot is valid. In a masked cell a tenth of a
/// spacing is added, so that such a foot answers only where every valid one is clearly farther, as
/// in a gap between valid cells; and where the cell is as steep as a silhouette, so much that it
/// answers last.
[[nodiscard]] MapFoot closest_on_map(const DistanceMap& map, std::uint32_t layer,
                                     const SupportPlane& plane, const Vector3& point) noexcept;

/// Unit normal at a foot, towards the plane's side (eq. 5), continuous over the borders of valid
/// cells. Not finite where a sample around it has no hit.
[[nodiscard]] Vector3 normal_at(const DistanceMap& map, std::uint32_t layer,
                                const SupportPlane& plane, const MapCell& cell) noexcept;

}  // namespace spm
