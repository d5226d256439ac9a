// SPDX-License-Identifier: Apache-2.0
#include "common/query/query_cursor.hpp"

namespace spm {

namespace {

/// Nearer to a leaf's border than this share of its edge, rounding might decide for the next.
constexpr double certain_share = 1 - 1e-9;

}  // namespace

void QueryCursor::enter(const Vector3& point) noexcept {
  leaf_ = leaf_at(asset_->octree, point);
  inner_ = leaf_.level < 0 ? -1 : certain_share * leaf_.half;
  by_maps_ = false;
  if (leaf_.kind == OctreeKind::deep) told_ = query_leaf(*asset_, leaf_, point);
  if (has_polynomials(leaf_.kind)) {
    const std::uint32_t* words = words_at(asset_->octree, leaf_);
    by_maps_ = words != nullptr && unpack_leaf_maps(*asset_, leaf_, words, maps_);
  }
}

QueriedDistance QueryCursor::tell_leaf(const Vector3& point) noexcept {
  told_ = query_leaf(*asset_, leaf_, point);
  point_ = point;
  if (told_.status != Status::exact) return {told_.distance, told_.status};
  beyond_ = clearance_told(*asset_, told_.distance);
  return in_band(*asset_, told_.distance);
}

double QueryCursor::bend_of_map() const noexcept {
  const std::uint32_t* words = words_at(asset_->octree, leaf_);
  if (words == nullptr) return 0;
  const NamedMaps maps(words[0]);
  if (maps.two() || maps.first >= asset_->charts.size()) return 0;
  return bend_on(asset_->charts[maps.first], point_);
}

Answer QueryCursor::query(const Vector3& point) noexcept {
  const QueriedDistance found = distance(point);
  if (!found.known()) return unanswered(found.status);
  Answer answer;
  if (by_maps_) {
    answer.plane = static_cast<std::int32_t>(maps_.of(on_).plane);
    answer.source = Source::polynomial;
  } else {
    answer = told_;
  }
  answer.distance = found.distance;
  answer.normal = normal();
  answer.status = found.status;
  return answer;
}

double QueryCursor::clearance(const Vector3& point, double useful) const noexcept {
  if (!point.allFinite()) return 0;
  if (beyond_field(*asset_, outside_)) return box_clearance(*asset_, outside_, useful);
  if (leaf_.level >= 0 && leaf_.kind != OctreeKind::far) return beyond_;
  return leaf_clearance(*asset_, leaf_, point, useful);
}

LocalQuadric QueryCursor::quadric(const Vector3& point) const noexcept {
  LocalQuadric made;
  if (leaf_.kind == OctreeKind::deep) {
    made.distance = told_.distance;
    made.normal = told_.normal;
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
