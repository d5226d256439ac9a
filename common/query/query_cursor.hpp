// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>

#include "common/query/octree_query.hpp"

namespace spm {

/// query_point for points that follow closely on one another: while they stay in one leaf of the
/// octree, it is not looked up again. The answers are those of query_point, bit by bit. `sparse`
/// only. The asset must outlive its use here. Never throws or allocates.
class QueryCursor {
 public:
  /// Forgets the leaf; `asset` may be null until the next query.
  void begin(const AssetView* asset) noexcept {
    asset_ = asset;
    inner_ = -1;
  }
  [[nodiscard]] Answer query(const Vector3& point) noexcept;
  /// The same without all but the distance.
  [[nodiscard]] QueriedDistance distance(const Vector3& point) noexcept;
  /// The normal of the last query whose distance is known, unit, outward.
  [[nodiscard]] const Vector3& normal() const noexcept { return told_.normal; }
  /// 1/m: the trace of a map's bend at the last point; 0 where not one map is the field.
  [[nodiscard]] double bend() const noexcept;
  /// `clearance` of a point that was the last to be queried; above `useful`, m, it need not be a
  /// good bound, which is quicker.
  [[nodiscard]] double clearance(
      const Vector3& point, double useful = std::numeric_limits<double>::infinity()) const noexcept;

 private:
  [[nodiscard]] bool within(const Vector3& point) const noexcept {
    return std::abs(point[0] - leaf_.middle[0]) < inner_ &&
           std::abs(point[1] - leaf_.middle[1]) < inner_ &&
           std::abs(point[2] - leaf_.middle[2]) < inner_;
  }
  /// Goes to the leaf around a point.
  void enter(const Vector3& point) noexcept;

  const AssetView* asset_ = nullptr;
  Leaf leaf_;
  double inner_ = -1;  ///< m: half the edge of the cube in which the leaf is certain; below 0: none
  OutsideBox outside_;  ///< of the last point
  double beyond_ = 0;   ///< m: clearance of the last point, as the leaf's answer tells it
  Vector3 point_ = Vector3::Zero();  ///< the last one that a leaf answered
  Answer told_;                      ///< of the last point; in all of a leaf deeper than the band
};

}  // namespace spm
