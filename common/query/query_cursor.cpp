// SPDX-License-Identifier: Apache-2.0
#include "common/query/query_cursor.hpp"

#include "common/query/octree_query.hpp"

namespace spm {

namespace {

/// Nearer to a leaf's border than this share of its edge, rounding might decide for the next.
constexpr double certain_share = 1 - 1e-9;

}  // namespace

Answer QueryCursor::query(const Vector3& point) noexcept {
  if (!within(point, inner_)) {
    leaf_ = leaf_at(asset_->octree, point);
    inner_ = leaf_.level < 0 ? -1 : certain_share * leaf_.half;
    by_maps_ = false;
    if (leaf_.kind == OctreeKind::deep) deep_ = query_leaf(*asset_, leaf_, point);
    if (leaf_.kind == OctreeKind::polynomial || leaf_.kind == OctreeKind::least ||
        leaf_.kind == OctreeKind::most) {
      const std::uint32_t* words = units_at(asset_->octree, leaf_);
      by_maps_ = words != nullptr && unpack_leaf_maps(*asset_, leaf_, words, maps_);
    }
  }
  beyond_ = 0;
  if (leaf_.kind == OctreeKind::deep) return deep_;
  Answer answer =
      by_maps_ ? answer_by_maps(*asset_, leaf_, maps_, point) : query_leaf(*asset_, leaf_, point);
  beyond_ = clearance_told(*asset_, answer);
  apply_band(*asset_, answer);
  return answer;
}

double QueryCursor::clearance(const Vector3& point, double useful) const noexcept {
  if (!point.allFinite()) return 0;
  if (leaf_.level >= 0 && leaf_.kind != OctreeKind::far) return beyond_;
  return leaf_clearance(*asset_, leaf_, point, useful);
}

LocalQuadric QueryCursor::quadric(const Vector3& point) const noexcept {
  LocalQuadric made;
  if (leaf_.kind == OctreeKind::deep) {
    made.distance = deep_.distance;
    made.normal = deep_.normal;
    return made;
  }
  const LocalMap& map = maps_.first;
  const SupportPlane& plane = asset_->planes[map.plane];
  const Vector3 z = local_coordinates(plane, leaf_.per_half * (point - leaf_.middle));
  Eigen::Matrix3d axes;
  axes << plane.u.transpose(), plane.v.transpose(), -plane.n.transpose();
  Eigen::Matrix3d bend;
  bend << map.bend[0], map.bend[3] / 2, map.bend[4] / 2,  //
      map.bend[3] / 2, map.bend[1], map.bend[5] / 2,      //
      map.bend[4] / 2, map.bend[5] / 2, map.bend[2];
  made.distance = leaf_.half * map.at(z);
  made.slope = axes.transpose() * map.gradient(z);
  made.normal = made.slope.normalized();
  made.bend = leaf_.per_half * (axes.transpose() * bend * axes);
  return made;
}

}  // namespace spm
