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
  if (leaf_.kind == OctreeKind::deep) told_ = query_leaf(*asset_, leaf_, point);
}

QueriedDistance QueryCursor::distance(const Vector3& point) noexcept {
  beyond_ = 0;
  outside_ = outside_box(*asset_, point);
  if (beyond_field(*asset_, outside_)) {
    return {std::numeric_limits<double>::quiet_NaN(), Status::far};
  }
  if (!within(point)) enter(point);
  if (leaf_.kind == OctreeKind::deep) return {told_.distance, Status::deep};
  told_ = query_leaf(*asset_, leaf_, point);
  point_ = point;
  if (told_.status != Status::exact) return {told_.distance, told_.status};
  beyond_ = clearance_told(*asset_, told_.distance);
  return in_band(*asset_, told_.distance);
}

double QueryCursor::bend() const noexcept {
  if (leaf_.kind != OctreeKind::map) return 0;
  const std::uint32_t* words = words_at(asset_->octree, leaf_);
  if (words == nullptr) return 0;
  const NamedMaps maps(words[0]);
  if (maps.two() || maps.first >= asset_->charts.size()) return 0;
  return bend_on(asset_->charts[maps.first], point_);
}

Answer QueryCursor::query(const Vector3& point) noexcept {
  const QueriedDistance found = distance(point);
  if (!found.known()) return unanswered(found.status);
  Answer answer = told_;
  answer.distance = found.distance;
  answer.status = found.status;
  return answer;
}

double QueryCursor::clearance(const Vector3& point, double useful) const noexcept {
  if (!point.allFinite()) return 0;
  if (beyond_field(*asset_, outside_)) return box_clearance(*asset_, outside_, useful);
  if (leaf_.level >= 0 && leaf_.kind != OctreeKind::far) return beyond_;
  return leaf_clearance(*asset_, leaf_, point, useful);
}

}  // namespace spm
