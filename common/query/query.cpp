// SPDX-License-Identifier: Apache-2.0
#include "common/query/query.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/query/closest_element.hpp"
#include "common/query/full_query.hpp"
#include "common/query/listed_closest_points.hpp"
#include "common/surface/closest_on_tile.hpp"

namespace spm {

namespace {

/// A closest point whose normal passes through the query point, within this cosine, lies on a face
/// and not on an edge: the face's normal is the answer. Narrower than facing_cosine, which only
/// chooses among closest points.
constexpr float face_normal_cosine = 0.9995F;
/// Nearer to the surface than this part of the tolerance, the direction to the closest point is
/// noise.
constexpr double surface_share = 0.1;

/// Outward normal of the solid at a closest point, for a query point on the given side.
Vector3 normal_of(const AssetView& asset, const ElementClosestPoint& closest_point,
                  const Vector3& point, bool inside) noexcept {
  const double side = inside ? -1 : 1;
  // Away from the closest point's own normal the query point faces an edge, and the direction
  // between them is the gradient. On the surface itself that direction is noise.
  const bool close = closest_point.distance < surface_share * asset.tolerance;
  if (closest_point.tile == nullptr) {
    const Vector3 away = point - closest_point.on_triangle;
    const double height = closest_point.triangle_normal.dot(away);
    const bool faces =
        side * height >= static_cast<double>(face_normal_cosine) * closest_point.distance;
    return faces || close ? closest_point.triangle_normal
                          : Vector3(side * away / closest_point.distance);
  }
  const TileClosestPoint& on = closest_point.on_tile;
  const SupportPlane& plane = asset.planes[closest_point.tile->plane];
  const bool faces =
      std::abs(on.below) >= face_normal_cosine * on.distance && (on.below > 0) == inside;
  if (faces || close) {
    // Eq. 5, written in the plane's frame.
    return from_plane_frame(plane, static_cast<double>(on.slope_eta),
                            static_cast<double>(on.slope_omega), -1)
        .normalized();
  }
  return side * from_plane_frame(plane, static_cast<double>(on.away_eta),
                                 static_cast<double>(on.away_omega),
                                 static_cast<double>(on.away_depth))
                    .normalized();
}

/// On which side of the surface at a closest point the query point lies.
bool is_inside(const ElementClosestPoint& closest_point, const Vector3& point) noexcept {
  if (closest_point.tile != nullptr) return closest_point.on_tile.below > 0;
  return closest_point.triangle_normal.dot(point - closest_point.on_triangle) < 0;
}

/// The kind of the surroundings of a point; `unknown` where there is no answer.
CubeKind kind_of(SignKind kind) noexcept {
  switch (kind) {
    case SignKind::boundary:
      return CubeKind::boundary;
    case SignKind::inside:
      return CubeKind::inside;
    case SignKind::outside:
      return CubeKind::outside;
    default:
      return CubeKind::unknown;
  }
}

/// Sets the answer from the nearest closest point, and from the one whose direction counts.
void set_answer(const AssetView& asset, const ElementClosestPoint& nearest,
                const ElementClosestPoint& closest_point, const Vector3& point, bool inside,
                Answer& answer) noexcept {
  if (!std::isfinite(nearest.distance)) {
    answer = unanswered(Status::far);
    return;
  }
  answer.distance = inside ? -nearest.distance : nearest.distance;
  answer.normal = normal_of(asset, closest_point, point, inside);
  if (nearest.tile != nullptr) {
    answer.plane = static_cast<std::int32_t>(nearest.tile->plane);
    answer.layer = static_cast<std::int32_t>(nearest.tile->first_layer);
  }
  answer.source = nearest.tile != nullptr ? Source::map : Source::triangles;
  answer.status = Status::exact;
}

/// Answers from the elements of the list, or from the tree where there is no list.
void query_elements(const AssetView& asset, const IndexList& list, const Vector3& point,
                    CubeKind kind, Answer& answer) noexcept {
  const ElementReading reading = list.numbers != nullptr ? read_elements(asset, list, point)
                                                         : read_elements(asset, point, kind);
  const bool boundary = kind == CubeKind::boundary;
  const bool inside = boundary ? reading.sides.inside() : kind == CubeKind::inside;
  const ElementClosestPoint& nearest = reading.nearest;
  const bool faced =
      reading.facing.distance <= nearest.distance + facing_tolerances * asset.tolerance;
  set_answer(asset, nearest, faced ? reading.facing : nearest, point, inside, answer);
  if (boundary && answer.status == Status::exact) answer.distance = signed_distance(asset, reading);
}

/// Answers from the closest points on a list's primitives, in a place whose side is not known
/// beforehand.
void set_listed(const AssetView& asset, const ListedClosestPoints& closest_points,
                const Vector3& point, CubeKind kind, Answer& answer) noexcept {
  const ElementClosestPoint& closest_point = closest_points.faced();
  const bool inside =
      kind == CubeKind::one_sided ? is_inside(closest_point, point) : kind == CubeKind::inside;
  set_answer(asset, closest_points.nearest, closest_point, point, inside, answer);
}

/// Returns the distance of the surface, as in AnswerAndDistance.
double query_sparse(const AssetView& asset, const IndexList& list, const Vector3& point,
                    Answer& answer) noexcept {
  CubeKind kind = list.kind;
  if (kind == CubeKind::unknown || kind == CubeKind::beside) {
    const SignKind sign = sign_at(asset.sign_octree, point);
    const bool is_solid = sign == SignKind::inside;
    kind = kind == CubeKind::unknown || is_solid ? kind_of(sign) : CubeKind::unknown;
    if (kind == CubeKind::unknown) {
      answer = unanswered(sign == SignKind::pruned ? Status::pruned : Status::far);
      return -1;
    }
  }
  if (kind == CubeKind::far) {
    answer = unanswered(Status::far);
    return -1;
  }
  if (list.numbers == nullptr || kind == CubeKind::boundary) {
    query_elements(asset, list, point, kind, answer);
    return -1;
  }
  const ListedClosestPoints closest_points = listed_closest_points(asset, list, point);
  set_listed(asset, closest_points, point, kind, answer);
  return closest_points.nearest.distance;
}

/// Completes an answer beyond the band.
void settle(const AssetView& asset, Answer& answer) noexcept {
  if (answer.status != Status::exact) return;
  if (answer.distance > asset.band.margin + asset.tolerance) {
    answer = unanswered(Status::far);
  } else if (answer.distance < -asset.band.max_depth) {
    answer.distance = -asset.band.max_depth;
    answer.status = Status::deep;
  }
}

/// At most points_at_once points, one step of each at a time.
void query_some(const AssetView& asset, std::span<const Vector3> points,
                std::span<Answer> answers) noexcept {
  std::array<IndexList, points_at_once> lists;
  std::array<PackedNumbers, points_at_once> names;
  std::array<std::array<float, 3>, points_at_once> places;
  std::array<std::size_t, points_at_once> listed, others;
  std::array<NearestPrimitive, points_at_once> found;
  std::size_t count = 0, rest = 0;
  lists_at(asset.index, points, lists.data());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const IndexList& list = lists[i];
    const bool by_list = list.numbers != nullptr && list.kind != CubeKind::boundary &&
                         list.kind != CubeKind::unknown;
    others[rest] = i;
    rest += by_list ? 0 : 1;
    listed[count] = i;
    names[count] = packed_numbers_of(asset.index, list, list.nearest);
    places[count] = from_origin(asset.bvh, points[i]);
    count += by_list ? 1 : 0;
  }
  nearest_primitives(asset.index.packets, std::span(names).first(count),
                     std::span(places).first(count), std::span(found).first(count));
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = listed[k];
    answers[i] = {};
    set_listed(asset, listed_closest_points(asset, lists[i], points[i], found[k]), points[i],
               lists[i].kind, answers[i]);
    settle(asset, answers[i]);
  }
  for (std::size_t k = 0; k < rest; ++k) {
    const std::size_t i = others[k];
    answers[i] = query_point(asset, lists[i], points[i]).answer;
  }
}

}  // namespace

Answer query_point(const AssetView& asset, const Vector3& point) noexcept {
  Answer answer;
  if (asset.full) {
    answer = query_full(asset, point);
  } else {
    static_cast<void>(query_sparse(asset, list_at(asset.index, point), point, answer));
  }
  settle(asset, answer);
  return answer;
}

AnswerAndDistance query_point(const AssetView& asset, const IndexList& list,
                              const Vector3& point) noexcept {
  AnswerAndDistance found;
  found.distance = query_sparse(asset, list, point, found.answer);
  settle(asset, found.answer);
  return found;
}

void query_points(const AssetView& asset, std::span<const Vector3> points,
                  std::span<Answer> answers) noexcept {
  const std::size_t count = std::min(points.size(), answers.size());
  for (std::size_t first = 0; first < count; first += points_at_once) {
    const std::size_t some = std::min(points_at_once, count - first);
    if (asset.full || asset.index.words.empty()) {
      for (std::size_t i = first; i < first + some; ++i) answers[i] = query_point(asset, points[i]);
    } else {
      query_some(asset, points.subspan(first, some), answers.subspan(first, some));
    }
  }
}

}  // namespace spm
