// SPDX-License-Identifier: Apache-2.0
#include "common/query/octree_query.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "common/base/octahedral.hpp"
#include "common/field/nearest_triangle.hpp"
#include "common/field/side_by_crossings.hpp"
#include "common/query/band_distance.hpp"
#include "common/surface/closest_on_triangle.hpp"
#include "common/surface/edge_distance.hpp"

namespace spm {

namespace {

/// Nearer to the surface than this share of the tolerance, the direction to it is noise, and the
/// triangle's own normal is the answer.
constexpr double surface_share = 1e-3;
/// Nearer than so many lattice steps, directions need more than single precision.
constexpr float min_steps = 16;

struct ClosestOnList {
  Vector3 away = Vector3::Zero();    ///< from there to the place
  Vector3 normal = Vector3::Zero();  ///< of its triangle, of no certain length
  double distance = -1;              ///< below 0: none
  std::optional<bool> inside;        ///< the side that it tells, if any
};

ClosestOnList closest_on_list(const AssetView& asset, const TriangleList& list, ListPart part,
                              const Vector3& point) noexcept {
  ClosestOnList closest;
  const NearestTriangle nearest =
      nearest_triangle(asset.exact, list, part, asset.octree.reach, point);
  if (!std::isfinite(nearest.square)) return closest;
  const FeatureSides sides = traits_of(asset.exact, nearest.triangle).sides;
  const double step = asset.exact.step,
               distance = step * std::sqrt(static_cast<double>(nearest.square));
  if (nearest.has_closest && nearest.square > min_steps * min_steps &&
      distance > surface_share * asset.tolerance) {
    closest.away = {step * static_cast<double>(nearest.away[0]),
                    step * static_cast<double>(nearest.away[1]),
                    step * static_cast<double>(nearest.away[2])};
    closest.distance = distance;
    const auto along = static_cast<double>(nearest.along);
    closest.inside = is_side(nearest.feature) ? side_told(sides, nearest.feature, along,
                                                          corners_of(asset.exact, nearest.triangle),
                                                          point - closest.away, distance * distance)
                                              : side_told(sides, nearest.feature, along);
    return closest;
  }
  const auto corners = corners_of(asset.exact, nearest.triangle);
  const ClosestFeature on = closest_feature(point, corners[0], corners[1], corners[2]);
  const double x = point[0] - on.point[0], y = point[1] - on.point[1], z = point[2] - on.point[2];
  closest.away = {x, y, z};
  closest.normal = {on.normal[0], on.normal[1], on.normal[2]};
  closest.distance = std::sqrt(x * x + y * y + z * z);
  closest.inside = side_told(sides, on.feature, along_normal(closest.normal, closest.away), corners,
                             on.point, closest.away.squaredNorm());
  return closest;
}

/// Whether the point is inside the solids.
bool is_inside(const AssetView& asset, const Leaf& leaf, const TriangleList& list,
               const ClosestOnList& closest, const Vector3& point) noexcept {
  if (list.side != ListSide::surface) return list.side == ListSide::inside;
  if (closest.inside) return *closest.inside;
  return side_by_crossings(asset.exact, list, leaf.middle, leaf.half, point, closest.distance)
      .value_or(false);
}

Answer answer_by_list(const AssetView& asset, const Leaf& leaf, const std::uint32_t* unit,
                      const Vector3& point) noexcept {
  const TriangleList list = list_of(asset.octree, unit);
  ClosestOnList closest = closest_on_list(asset, list, ListPart::solids, point);
  bool inside = is_inside(asset, leaf, list, closest, point);
  double distance = inside ? -closest.distance : closest.distance;
  if (list.sheets != 0) {
    const ClosestOnList sheet = closest_on_list(asset, list, ListPart::sheets, point);
    const double beside = sheet.distance - asset.sheet_thickness;
    if (sheet.distance >= 0 && (closest.distance < 0 || beside < distance)) {
      closest = sheet;
      inside = false;
      distance = beside;
    }
  }
  if (closest.distance < 0) return unanswered(Status::far);
  Answer answer;
  answer.distance = distance;
  answer.source = Source::triangles;
  answer.status = Status::exact;
  if (closest.distance > surface_share * asset.tolerance) {
    const double per = (inside ? -1 : 1) / closest.distance;
    const double x = per * closest.away[0], y = per * closest.away[1], z = per * closest.away[2];
    // The distance may be of single precision, so that one of Newton's steps makes the length 1.
    const double right = 1.5 - 0.5 * (x * x + y * y + z * z);
    answer.normal = {right * x, right * y, right * z};
  } else if (closest.normal != Vector3::Zero()) {
    answer.normal = closest.normal.normalized();
  } else {
    answer.normal = Vector3::UnitZ();
  }
  return answer;
}

/// What one distance map tells. In single numbers: answers that are put together from them and
/// copied as a whole would wait for memory.
struct ToldByChart {
  bool known = false;  ///< false where P_M is not on the map
  double distance = 0, x = 0, y = 0, z = 0;
  std::uint32_t plane = 0;
};

/// d = -(S_SP - D_SP(P_M)) / |n_S| and n_S of length 1 (eq. 3 to 5). That is the distance of the
/// surface's tangent plane at P_M: the paper's eq. 3 with the cosine between n_S and n_SP as the
/// only difference. On a map of an offset surface, what that is off the surface is added.
[[gnu::always_inline]] inline ToldByChart told_by_chart(const AssetView& asset, std::uint32_t chart,
                                                        const Vector3& point) noexcept {
  MapContact contact;
  if (chart >= asset.charts.size() || !contact_on(asset.charts[chart], point, contact)) return {};
  const Vector3& n = contact.normal;
  const double square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
  // A root and a quotient that do not wait for each other.
  const double per = std::sqrt(square) * (1 / square);
  const HeightChart& map = asset.charts[chart];
  return {true,       static_cast<double>(map.offset) - per * contact.penetration,
          per * n[0], per * n[1],
          per * n[2], map.plane};
}

[[gnu::always_inline]] inline Answer map_answer(const ToldByChart& told) noexcept {
  if (!told.known) return unanswered(Status::far);
  Answer answer;
  answer.distance = told.distance;
  answer.normal = {told.x, told.y, told.z};
  answer.plane = static_cast<std::int32_t>(told.plane);
  answer.source = Source::map;
  answer.status = Status::exact;
  return answer;
}

/// The answer of two distance maps and the edge where their surfaces meet.
[[gnu::noinline]] Answer answer_by_two(const AssetView& asset, const NamedMaps& maps,
                                       const Vector3& point) noexcept {
  const ToldByChart n = told_by_chart(asset, maps.first, point),
                    m = told_by_chart(asset, maps.second(), point);
  const double sign = maps.pair.larger ? 1 : -1;
  const double cosine = maps.pair.edge ? n.x * m.x + n.y * m.y + n.z * m.z : 1;
  const EdgeDistance edge = edge_distance(sign * n.distance, sign * m.distance, cosine);
  return map_answer({n.known && m.known, sign * edge.distance, edge.first * n.x + edge.second * m.x,
                     edge.first * n.y + edge.second * m.y, edge.first * n.z + edge.second * m.z,
                     edge.second > edge.first ? m.plane : n.plane});
}

/// The answer of one distance map, or of two.
[[gnu::always_inline]] inline Answer answer_by_map(const AssetView& asset, std::uint32_t word,
                                                   const Vector3& point) noexcept {
  const NamedMaps maps(word);
  return maps.two() ? answer_by_two(asset, maps, point)
                    : map_answer(told_by_chart(asset, maps.first, point));
}

/// How far the surface is at the least, m, by the distances that `far` roots know of their middles:
/// of the eight whose middles are around the point. One that lies behind it, as seen from the
/// surface, tells most. Below 0 where none tells.
double told_by_roots(const DistanceOctree& octree, const Vector3& point) noexcept {
  std::array<std::array<double, 2>, 3> squares;
  std::array<std::array<std::uint64_t, 2>, 3> roots;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<Eigen::Index>(axis);
    const double last = std::max(1.0, static_cast<double>(octree.roots[axis])) - 1;
    const double at = (point[k] - octree.origin[k]) * octree.per_edge - 0.5;
    // Rounded towards 0, which is down from there.
    const auto low = static_cast<double>(static_cast<std::int64_t>(std::clamp(at, 0.0, last)));
    for (std::size_t side = 0; side < 2; ++side) {
      const double root = std::min(low + static_cast<double>(side), last);
      roots[axis][side] = static_cast<std::uint64_t>(root);
      const double off = octree.edge * (at - root);
      squares[axis][side] = off * off;
    }
  }
  double told = -1;
  for (std::size_t octant = 0; octant < 8; ++octant) {
    const std::size_t x = octant & 1U, y = octant >> 1U & 1U, z = octant >> 2U;
    const std::uint64_t place =
        roots[0][x] + octree.roots[0] * (roots[1][y] + octree.roots[1] * roots[2][z]);
    const std::optional<OctreeRoot> root = root_at(octree, place);
    if (!root || root->kind != OctreeKind::far) continue;
    const double away = std::sqrt(squares[0][x] + squares[1][y] + squares[2][z]);
    told = std::max(told, octree.clearance_unit * static_cast<double>(root->word) - away);
  }
  return told;
}

}  // namespace

Answer query_leaf(const AssetView& asset, const Leaf& leaf, const Vector3& point) noexcept {
  // The only kind without words that has an answer; there may be no words at all.
  if (leaf.kind == OctreeKind::pruned) return unanswered(Status::pruned);
  const std::uint32_t* words = words_at(asset.octree, leaf);
  if (words == nullptr) return unanswered(Status::far);
  switch (leaf.kind) {
    case OctreeKind::map:
      return answer_by_map(asset, words[0], point);
    case OctreeKind::list:
      return answer_by_list(asset, leaf, words, point);
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
  const FoundLeaf found = find_leaf(asset.octree, point);
  // Most answers are of maps, which need no more of a leaf than its word.
  if (found.kind == OctreeKind::map) {
    const std::uint32_t* words = words_at(asset.octree, found.kind, found.word);
    if (words != nullptr) return answer_by_map(asset, words[0], point);
  }
  return query_leaf(asset, leaf_of(asset.octree, found), point);
}

double clearance(const AssetView& asset, const Vector3& point) noexcept {
  if (asset.full || !point.allFinite()) return 0;
  return leaf_clearance(asset, leaf_at(asset.octree, point), point);
}

double leaf_clearance(const AssetView& asset, const Leaf& leaf, const Vector3& point,
                      double useful) noexcept {
  const DistanceOctree& octree = asset.octree;
  const OutsideBox from = outside_box(asset, point);
  if (beyond_field(asset, from)) return box_clearance(asset, from, useful);
  if (leaf.level >= 0 && leaf.kind != OctreeKind::far) {
    const Answer told = query_leaf(asset, leaf, point);
    return told.status == Status::exact ? clearance_told(asset, told.distance) : 0;
  }
  if (from.square > 0) return box_clearance(asset, from, useful);
  if (leaf.level < 0) {
    // Beyond all roots the surface is farther than they are, by the margin.
    const Vector3 high =
        octree.origin + octree.edge * Vector3(octree.roots[0], octree.roots[1], octree.roots[2]);
    const Vector3 outside =
        (octree.origin - point).cwiseMax(point - high).cwiseMax(Vector3::Zero());
    return std::max(asset.band.margin + outside.norm(), told_by_roots(octree, point));
  }
  const double told = told_by_roots(octree, point);
  if (told > std::min(octree.edge, useful)) return told;
  // The way to the surface leaves the cubes beyond the margin, and is that long from there on.
  const double most = std::min(octree.edge, useful - asset.band.margin);
  const double to_band = most > 0 ? distance_to_band(octree, point, most) : 0;
  return std::max(told, asset.band.margin + to_band);
}

double box_clearance(const AssetView& asset, const OutsideBox& from, double useful) noexcept {
  if (from.square > useful * useful) return shortened_bound * std::sqrt(from.square);
  const Leaf leaf = leaf_at(asset.octree, from.nearest);
  double beside = 0;
  if (leaf.kind == OctreeKind::far && leaf.level >= 0) {
    beside = leaf_clearance(asset, leaf, from.nearest, useful);
  } else if (leaf.kind == OctreeKind::map) {
    const Answer told = query_leaf(asset, leaf, from.nearest);
    if (told.status == Status::exact) {
      const double within = std::min(told.distance, asset.band.margin) - asset.tolerance;
      beside = std::max({0.0, within, clearance_told(asset, told.distance)});
    }
  }
  return shortened_bound * std::sqrt(from.square + beside * beside);
}

}  // namespace spm
