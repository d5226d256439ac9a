// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "common/query/leaf_maps.hpp"
#include "common/query/octree_query.hpp"

namespace spm {

/// The field about a point, where one polynomial is all of it: distance(point + r) = distance +
/// slope . r + r' bend r. Deeper than the band it is the band's depth, with one normal.
struct LocalQuadric {
  double distance = 0;
  Vector3 slope = Vector3::Zero();
  Eigen::Matrix3d bend = Eigen::Matrix3d::Zero();  ///< 1/m
  Vector3 normal = Vector3::Zero();                ///< at the point, unit, outward
};

/// query_point for points that follow closely on one another: while they stay in one leaf of the
/// octree, it is neither looked up nor unpacked again. The answers are those of query_point, bit by
/// bit. `sparse` only. The asset must outlive its use here. Never throws or allocates.
class QueryCursor {
 public:
  /// Forgets the leaf; `asset` may be null until the next query.
  void begin(const AssetView* asset) noexcept {
    asset_ = asset;
    inner_ = -1;
  }
  [[nodiscard]] Answer query(const Vector3& point) noexcept;
  /// The same without the normal, which takes as long as the distance. Once in a leaf, it is found
  /// here.
  [[nodiscard]] QueriedDistance distance(const Vector3& point) noexcept {
    beyond_ = 0;
    outside_ = outside_box(*asset_, point);
    if (beyond_field(*asset_, outside_)) {
      return {std::numeric_limits<double>::quiet_NaN(), Status::far};
    }
    if (!within(point, inner_)) enter(point);
    if (leaf_.kind == OctreeKind::deep) return {told_.distance, Status::deep};
    if (!by_maps_) return tell_leaf(point);
    on_ = place_on_map(*asset_, leaf_, maps_, point);
    const double found = leaf_.half * on_.value;
    beyond_ = clearance_told(*asset_, found);
    return in_band(*asset_, found);
  }
  /// The normal of the last query whose distance is known, unit, outward.
  [[nodiscard]] Vector3 normal() const noexcept {
    return by_maps_ ? normal_on_map(*asset_, maps_, on_) : told_.normal;
  }
  /// 1/m: the trace of a leaf's bend (LocalQuadric), once in it, or of a map's at the last point; 0
  /// where neither one polynomial nor one map is its field.
  [[nodiscard]] double bend() const noexcept {
    if (leaf_.kind == OctreeKind::map) return bend_of_map();
    if (!by_maps_ || leaf_.kind != OctreeKind::polynomial) return 0;
    const auto& bend = maps_.first.bend;
    return leaf_.per_half * (bend[0] + bend[1] + bend[2]);
  }
  /// `clearance` of a point that was the last to be queried; above `useful`, m, it need not be a
  /// good bound, which is quicker.
  [[nodiscard]] double clearance(
      const Vector3& point, double useful = std::numeric_limits<double>::infinity()) const noexcept;
  /// Whether one polynomial is the field of all places within `radius` of a point, m: of one in the
  /// leaf of the last query. False where that is not certain.
  [[nodiscard]] bool is_quadric(const Vector3& point, double radius) const noexcept {
    return ((by_maps_ && leaf_.kind == OctreeKind::polynomial) || leaf_.kind == OctreeKind::deep) &&
           within(point, inner_ - radius);
  }
  /// That field.
  [[nodiscard]] LocalQuadric quadric(const Vector3& point) const noexcept;

 private:
  [[nodiscard]] bool within(const Vector3& point, double half) const noexcept {
    return std::abs(point[0] - leaf_.middle[0]) < half &&
           std::abs(point[1] - leaf_.middle[1]) < half &&
           std::abs(point[2] - leaf_.middle[2]) < half;
  }

  /// Goes to the leaf around a point.
  void enter(const Vector3& point) noexcept;
  [[nodiscard]] double bend_of_map() const noexcept;
  /// The answer of a leaf without polynomials.
  [[nodiscard]] QueriedDistance tell_leaf(const Vector3& point) noexcept;

  const AssetView* asset_ = nullptr;
  Leaf leaf_;
  double inner_ = -1;  ///< m: half the edge of the cube in which the leaf is certain; below 0: none
  bool by_maps_ = false;
  OutsideBox outside_;  ///< of the last point
  double beyond_ = 0;   ///< m: clearance of the last point, as the leaf's own answer tells it
  LeafMaps maps_;
  PlaceOnMap on_;                    ///< of the last point, by maps
  Vector3 point_ = Vector3::Zero();  ///< the last one, without polynomials
  Answer told_;  ///< of the last point, without polynomials; in all of a leaf deeper than the band
};

}  // namespace spm
