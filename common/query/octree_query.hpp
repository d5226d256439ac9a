// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "common/query/query.hpp"

namespace spm {

/// query_point of a `sparse` asset, before the band's ends are applied: one look-up in the octree,
/// then a polynomial or a short list of exact triangles.
[[nodiscard]] Answer query_octree(const AssetView& asset, const Vector3& point) noexcept;
/// The same where the leaf around the point is known.
[[nodiscard]] Answer query_leaf(const AssetView& asset, const Leaf& leaf,
                                const Vector3& point) noexcept;

/// `clearance` where the leaf around the point is known; above `useful`, m, it need not be a good
/// bound, which is quicker.
[[nodiscard]] double leaf_clearance(
    const AssetView& asset, const Leaf& leaf, const Vector3& point,
    double useful = std::numeric_limits<double>::infinity()) noexcept;

/// How far the surface is at the least, m, as a leaf's answer tells it before the band's ends are
/// applied; 0 where it does not tell.
[[nodiscard]] inline double clearance_told(const AssetView& asset, const Answer& answer) noexcept {
  const double beyond = answer.distance - asset.band.margin;
  if (answer.status != Status::exact || !(beyond > 0)) return 0;
  return asset.band.margin + asset.octree.beyond_share * beyond;
}

/// Completes an answer beyond the band.
inline void apply_band(const AssetView& asset, Answer& answer) noexcept {
  if (answer.status != Status::exact) return;
  if (answer.distance > asset.band.margin + asset.tolerance) {
    answer = unanswered(Status::far);
  } else if (answer.distance < -asset.band.max_depth) {
    answer.distance = -asset.band.max_depth;
    answer.status = Status::deep;
  }
}

}  // namespace spm
