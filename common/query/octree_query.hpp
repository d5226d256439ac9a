// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>

#include "common/query/query.hpp"

namespace spm {

/// query_point of a `sparse` asset, before the band's ends are applied: one look-up in the octree,
/// then a distance map, or two, or a short list of exact triangles.
[[nodiscard]] Answer query_octree(const AssetView& asset, const Vector3& point) noexcept;
/// The same where the leaf around the point is known.
[[nodiscard]] Answer query_leaf(const AssetView& asset, const Leaf& leaf,
                                const Vector3& point) noexcept;

/// `clearance` where the leaf around the point is known; above `useful`, m, it need not be a good
/// bound, which is quicker.
[[nodiscard]] double leaf_clearance(
    const AssetView& asset, const Leaf& leaf, const Vector3& point,
    double useful = std::numeric_limits<double>::infinity()) noexcept;

/// Where a place is from an asset's box, which holds all of its surface.
struct OutsideBox {
  Vector3 nearest = Vector3::Zero();  ///< of the box
  double square = 0;                  ///< of the distance from there, m2; 0 in the box
};
[[nodiscard]] inline OutsideBox outside_box(const AssetView& asset, const Vector3& point) noexcept {
  OutsideBox found;
  for (int k = 0; k < 3; ++k) {
    found.nearest[k] = std::min(std::max(point[k], asset.box_low[k]), asset.box_high[k]);
    const double off = point[k] - found.nearest[k];
    found.square += off * off;
  }
  return found;
}
/// Whether that is so far outside that no answer there lies in the band: each is right to a
/// tolerance, and may lie beyond the margin by one.
[[nodiscard]] inline bool beyond_field(const AssetView& asset, const OutsideBox& from) noexcept {
  const double most = asset.band.margin + 3 * asset.tolerance;
  return from.square > most * most;
}
/// `clearance` of a place that is outside the box: seen from the nearest place of that, which is
/// convex, no part of the surface lies in front of a right angle. `useful` as above.
[[nodiscard]] double box_clearance(
    const AssetView& asset, const OutsideBox& from,
    double useful = std::numeric_limits<double>::infinity()) noexcept;

/// How far the surface is at the least, m, where a leaf's answer before the band's ends are applied
/// is this distance, m; 0 where it does not tell.
[[nodiscard]] inline double clearance_told(const AssetView& asset, double distance) noexcept {
  const double beyond = distance - asset.band.margin;
  return beyond > 0 ? asset.band.margin + asset.octree.beyond_share * beyond : 0;
}

/// Whether an exact distance, m, is in the band, or beyond which of its ends.
[[nodiscard]] inline Status status_in_band(const AssetView& asset, double distance) noexcept {
  if (distance > asset.band.margin + asset.tolerance) return Status::far;
  return distance < -asset.band.max_depth ? Status::deep : Status::exact;
}

/// What a query tells but for the normal.
struct QueriedDistance {
  double distance = 0;  ///< as Answer's
  Status status = Status::far;
  [[nodiscard]] bool known() const noexcept { return is_known(status); }
};

/// The same of an exact distance, m, once the band's ends are applied.
[[nodiscard]] inline QueriedDistance in_band(const AssetView& asset, double distance) noexcept {
  const Status status = status_in_band(asset, distance);
  if (status == Status::exact) return {distance, status};
  return {status == Status::deep ? -asset.band.max_depth : std::numeric_limits<double>::quiet_NaN(),
          status};
}

/// Completes an answer beyond the band.
inline void apply_band(const AssetView& asset, Answer& answer) noexcept {
  if (answer.status != Status::exact) return;
  answer.status = status_in_band(asset, answer.distance);
  if (answer.status == Status::far) answer = unanswered(Status::far);
  if (answer.status == Status::deep) answer.distance = -asset.band.max_depth;
}

}  // namespace spm
