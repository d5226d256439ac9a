// SPDX-License-Identifier: Apache-2.0
#include "common/query/full_query.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "common/asset/grid_list.hpp"
#include "common/base/octahedral.hpp"
#include "common/surface/closest_on_map.hpp"
#include "common/surface/closest_on_triangle.hpp"

namespace spm {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Closest points on triangles that are nearer to each other than this part of a cell are one
/// place: an edge or corner.
constexpr double tie_share_of_cell = 2e-5;

Answer deep_answer(const Band& band, const Vector3& normal) noexcept {
  Answer answer;
  answer.distance = -band.max_depth;
  answer.normal = normal;
  answer.status = Status::deep;
  return answer;
}

/// The closest point of least rank among the maps of a list.
Answer closest_of_maps(const AssetView& asset, const GridList& list,
                       const Vector3& point) noexcept {
  const DistanceMap* map = nullptr;
  std::uint32_t layer = 0;
  MapClosestPoint best;
  best.rank = infinity;
  for (std::uint32_t k = 0; k < list.maps(); ++k) {
    const auto [which, candidate_layer] = unpack_candidate(list.map(k));
    if (which >= asset.maps.size() || candidate_layer >= asset.maps[which].layers) continue;
    const DistanceMap& candidate_map = asset.maps[which];
    const MapClosestPoint closest_point =
        closest_on_map(candidate_map, candidate_layer, asset.planes[candidate_map.plane], point);
    if (!(closest_point.rank < best.rank)) continue;
    best = closest_point;
    map = &candidate_map;
    layer = candidate_layer;
  }
  if (map == nullptr) return unanswered(Status::far);
  const Vector3 normal = normal_at(*map, layer, asset.planes[map->plane], best.cell);
  if (!normal.allFinite()) return unanswered(Status::far);
  const double side = side_of_crossing(layer);
  Answer answer;
  answer.distance = side * best.distance;
  answer.normal = side * normal;
  answer.plane = static_cast<std::int32_t>(map->plane);
  answer.layer = static_cast<std::int32_t>(layer);
  answer.source = Source::map;
  answer.status = Status::exact;
  return answer;
}

/// The corners of a triangle, m; false where there is no such triangle.
bool triangle_corners(const AssetView& asset, std::size_t triangle,
                      std::array<Vector3, 3>& corners) noexcept {
  if (9 * triangle + 9 > asset.triangles.size()) return false;
  const float* number = asset.triangles.data() + 9 * triangle;
  for (Vector3& corner : corners) {
    corner = Vector3(number[0], number[1], number[2]);
    number += 3;
  }
  return true;
}

/// Of sheets there is no inside: they are felt at a half-thickness from either side.
void meet_sheet(const AssetView& asset, const std::array<Vector3, 3>& corners, const Vector3& point,
                Answer& answer) noexcept {
  const auto& [a, b, c] = corners;
  const Vector3 away = point - closest_on_triangle(point, a, b, c);
  const double length = away.norm(), distance = length - asset.sheet_thickness;
  if (answer.status == Status::exact && answer.distance <= distance) return;
  answer.distance = distance;
  answer.normal = length > 0 ? Vector3(away / length) : (b - a).cross(c - a).normalized();
  answer.source = Source::triangles;
  answer.status = Status::exact;
}

/// The closest of a list's triangles. The side is that of the closest one of solids; where several
/// share the closest point (an edge, a corner), of the one that faces the point most.
Answer closest_of_triangles(const AssetView& asset, const GridList& list,
                            const Vector3& point) noexcept {
  const double tie = tie_share_of_cell * asset.grid.cell_size;
  double surface = infinity, deciding = infinity, facing = -1, side = 1;
  Vector3 closest_point = Vector3::Zero(), face_normal = Vector3::Zero();
  for (std::uint32_t k = 0; k < list.triangles(); ++k) {
    const std::uint32_t candidate = list.triangle(k);
    std::array<Vector3, 3> corners;
    if ((candidate & 1U) != 0 || !triangle_corners(asset, candidate >> 1U, corners)) continue;
    const auto& [a, b, c] = corners;
    const Vector3 nearest = closest_on_triangle(point, a, b, c);
    const double distance = (point - nearest).norm();
    if (distance > deciding + tie) continue;
    const Vector3 normal = (b - a).cross(c - a).normalized();
    const double height = normal.dot(point - nearest);
    const double faces = distance > 0 ? std::abs(height) / distance : 1;
    const bool clearly_closer = distance < deciding - tie;
    if (clearly_closer || (distance <= deciding + tie && faces > facing)) {
      side = height < 0 ? -1 : 1;
      facing = faces;
      deciding = clearly_closer ? distance : std::min(distance, deciding);
      face_normal = normal;
    }
    if (distance < surface) {
      surface = distance;
      closest_point = nearest;
    }
  }
  if (!std::isfinite(surface)) return unanswered(Status::far);
  Answer answer;
  answer.distance = side * surface;
  // On the surface itself the direction to the closest point is noise; the face's normal is not.
  answer.normal = surface > tie ? Vector3(side * (point - closest_point) / surface) : face_normal;
  answer.source = Source::triangles;
  answer.status = Status::exact;
  return answer;
}

}  // namespace

Answer query_full(const AssetView& asset, const Vector3& point) noexcept {
  const std::uint32_t word = grid_word_at(asset.grid, point);
  switch (static_cast<CellKind>(word >> 30U)) {
    case CellKind::far:
      return unanswered(Status::far);
    case CellKind::pruned:
      return unanswered(Status::pruned);
    case CellKind::deep:
      return deep_answer(asset.band, unpack_octahedral(word & payload_mask));
    case CellKind::record:
      break;
  }
  // A split below the last level: the file was damaged.
  if (is_split(word)) return unanswered(Status::far);
  const GridList list(asset.grid, word);
  Answer answer = closest_of_maps(asset, list, point);
  if (list.triangles() == 0) return answer;
  const Answer exact = closest_of_triangles(asset, list, point);
  const bool nearer =
      answer.status != Status::exact ||
      (exact.status == Status::exact && std::abs(exact.distance) < std::abs(answer.distance));
  if (nearer) answer = exact;
  for (std::uint32_t k = 0; k < list.triangles(); ++k) {
    std::array<Vector3, 3> corners;
    const std::uint32_t candidate = list.triangle(k);
    if ((candidate & 1U) != 0 && triangle_corners(asset, candidate >> 1U, corners)) {
      meet_sheet(asset, corners, point, answer);
    }
  }
  return answer;
}

}  // namespace spm
