// SPDX-License-Identifier: Apache-2.0
#include "common/query/octree_query.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/octahedral.hpp"
#include "common/field/local_map.hpp"
#include "common/field/nearest_triangle.hpp"
#include "common/surface/closest_on_triangle.hpp"

namespace spm {

namespace {

/// Nearer to the surface than this share of the tolerance, the direction to it is noise, and the
/// triangle's own normal is the answer.
constexpr double surface_share = 1e-3;
/// The clusters of a list, bounded by what is there.
struct ClusterList {
  std::span<const std::uint32_t> triangles, caps;
  ListSide side = ListSide::surface;
};

ClusterList list_of(const DistanceOctree& octree, const std::uint32_t* unit) noexcept {
  ClusterList list;
  const std::size_t first = unit[0], count = unit[1] & 0xFFFU;
  if (first > octree.lists.size() || count > octree.lists.size() - first) return list;
  const std::size_t caps = std::min<std::size_t>(unit[1] >> 12U & 0xFFFU, count);
  const auto all = octree.lists.subspan(first, count);
  list.triangles = all.first(count - caps);
  list.caps = all.last(caps);
  list.side = static_cast<ListSide>(unit[1] >> 24U & 3U);
  return list;
}

struct ClosestOnList {
  Vector3 point = Vector3::Zero();
  Vector3 normal = Vector3::Zero();  ///< of its triangle; 0 of one without an area
  double distance = -1;              ///< below 0: none
  bool inside = false;               ///< the side that it tells
};

ClosestOnList closest_on_list(const AssetView& asset, std::span<const std::uint32_t> list,
                              const Vector3& point) noexcept {
  ClosestOnList closest;
  const ListedTriangle nearest = nearest_triangle(asset.clusters, list, asset.octree.reach, point);
  if (!std::isfinite(nearest.square)) return closest;
  const std::uint32_t* cluster = asset.clusters.at(list[nearest.entry] & 0xFFFFFFU);
  const auto corners = corners_of(asset.clusters, cluster, nearest.triangle);
  const ClosestFeature on = closest_feature(point, corners[0], corners[1], corners[2]);
  closest.point = on.point;
  closest.distance = (point - closest.point).norm();
  const Vector3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  const double length = normal.norm();
  if (length > 0) closest.normal = normal / length;
  closest.inside =
      is_inside(sides_of(cluster, nearest.triangle), on.feature, normal.dot(point - closest.point));
  return closest;
}

Answer answer_by_list(const AssetView& asset, const std::uint32_t* unit,
                      const Vector3& point) noexcept {
  const ClusterList list = list_of(asset.octree, unit);
  const ClosestOnList closest = closest_on_list(asset, list.triangles, point);
  if (closest.distance < 0) return unanswered(Status::far);
  const Vector3 away = point - closest.point;
  bool inside = list.side == ListSide::inside;
  if (list.side == ListSide::surface) {
    inside = closest.inside;
    if (!list.caps.empty()) {
      const ClosestOnList cap = closest_on_list(asset, list.caps, point);
      if (cap.distance >= 0 && cap.distance < closest.distance) inside = cap.inside;
    }
  }
  Answer answer;
  answer.distance = inside ? -closest.distance : closest.distance;
  const bool close = closest.distance <= surface_share * asset.tolerance;
  answer.normal = close && closest.normal != Vector3::Zero()
                      ? closest.normal
                      : Vector3(away / (inside ? -closest.distance : closest.distance));
  if (!answer.normal.allFinite()) answer.normal = Vector3::UnitZ();
  answer.source = Source::triangles;
  answer.status = Status::exact;
  return answer;
}

/// A vector of length 1. The slope of a distance is nearly so long, where Newton's steps are right
/// to 1e-11 and faster than a root and a division.
Vector3 unit_of(const Vector3& slope) noexcept {
  const double square = slope.squaredNorm();
  if (!(std::abs(square - 1) < 0.25)) return slope.normalized();
  double length = 1.5 - 0.5 * square;
  for (int step = 0; step < 3; ++step) length *= 1.5 - 0.5 * square * length * length;
  return slope * length;
}

Answer answer_by_maps(const AssetView& asset, const Leaf& leaf, const std::uint32_t* words,
                      const Vector3& point) noexcept {
  const double unit = asset.octree.value_unit * leaf.per_half;
  const Vector3 offset = (point - leaf.middle) * leaf.per_half;
  LocalMap map = unpack_local_map(words, unit);
  if (map.plane >= asset.planes.size()) return unanswered(Status::far);
  Vector3 z = local_coordinates(asset.planes[map.plane], offset);
  double value = map.at(z);
  if (leaf.kind != OctreeKind::polynomial) {
    const LocalMap other = unpack_local_map(words + local_map_words, unit);
    if (other.plane >= asset.planes.size()) return unanswered(Status::far);
    const Vector3 other_z = local_coordinates(asset.planes[other.plane], offset);
    const double other_value = other.at(other_z);
    if ((other_value < value) == (leaf.kind == OctreeKind::least)) {
      map = other;
      z = other_z;
      value = other_value;
    }
  }
  const Vector3 slope = map.gradient(z);
  Answer answer;
  answer.distance = leaf.half * value;
  answer.normal = unit_of(from_plane_frame(asset.planes[map.plane], slope[0], slope[1], slope[2]));
  answer.plane = static_cast<std::int32_t>(map.plane);
  answer.source = Source::polynomial;
  answer.status = Status::exact;
  return answer;
}

}  // namespace

Answer query_leaf(const AssetView& asset, const Leaf& leaf, const Vector3& point) noexcept {
  // The only kind without words that has an answer; there may be no words at all.
  if (leaf.kind == OctreeKind::pruned) return unanswered(Status::pruned);
  const std::uint32_t* words = units_at(asset.octree, leaf);
  if (words == nullptr) return unanswered(Status::far);
  switch (leaf.kind) {
    case OctreeKind::polynomial:
    case OctreeKind::least:
    case OctreeKind::most:
      return answer_by_maps(asset, leaf, words, point);
    case OctreeKind::list:
      return answer_by_list(asset, words, point);
    case OctreeKind::deep: {
      Answer answer;
      answer.distance = -asset.band.max_depth;
      answer.normal = unpack_octahedral(words[0]);
      answer.status = Status::deep;
      return answer;
    }
    default:
      return unanswered(Status::far);
  }
}

Answer query_octree(const AssetView& asset, const Vector3& point) noexcept {
  return query_leaf(asset, leaf_at(asset.octree, point), point);
}

double clearance(const AssetView& asset, const Vector3& point) noexcept {
  if (asset.full || !point.allFinite()) return 0;
  const DistanceOctree& octree = asset.octree;
  const Leaf leaf = leaf_at(octree, point);
  if (leaf.level < 0) {
    // Beyond all roots the surface is farther than they are, by the margin.
    const Vector3 high =
        octree.origin + octree.edge * Vector3(octree.roots[0], octree.roots[1], octree.roots[2]);
    const Vector3 outside =
        (octree.origin - point).cwiseMax(point - high).cwiseMax(Vector3::Zero());
    return asset.band.margin + outside.norm();
  }
  if (leaf.kind != OctreeKind::far) {
    // A list or polynomial beyond the margin's end tells no more than that.
    return query_leaf(asset, leaf, point).distance > asset.band.margin ? asset.band.margin : 0;
  }
  if (leaf.level > 0) return asset.band.margin;
  const double at_middle = octree.clearance_unit * static_cast<double>(leaf.unit);
  return std::max(asset.band.margin, at_middle - (point - leaf.middle).norm());
}

}  // namespace spm
