// SPDX-License-Identifier: Apache-2.0
#include "common/query/query.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/query/closest_element.hpp"
#include "common/query/full_query.hpp"
#include "common/query/listed_feet.hpp"
#include "common/surface/closest_on_tile.hpp"

namespace spm {

namespace {

/// A closest point whose normal passes through the query point, within this cosine, lies on a face
/// and not on an edge.
constexpr float facing_share = 0.9995F;
/// Nearer to the surface than this part of the tolerance, the direction to the closest point is
/// noise.
constexpr double surface_share = 0.1;

/// Outward normal of the solid at a closest point, for a query point on the given side.
Vector3 normal_of(const AssetView& asset, const ElementFoot& foot, const Vector3& point,
                  bool inside) noexcept {
  const double side = inside ? -1 : 1;
  // Away from the closest point's own normal the query point faces an edge, and the direction
  // between them is the gradient. On the surface itself that direction is noise.
  const bool close = foot.distance < surface_share * asset.tolerance;
  if (foot.tile == nullptr) {
    const Vector3 away = point - foot.on_triangle;
    const double height = foot.triangle_normal.dot(away);
    const bool faces = side * height >= static_cast<double>(facing_share) * foot.distance;
    return faces || close ? foot.triangle_normal : Vector3(side * away / foot.distance);
  }
  const TileFoot& on = foot.on_tile;
  const SupportPlane& plane = asset.planes[foot.tile->plane];
  const bool faces = std::abs(on.below) >= facing_share * on.distance && (on.below > 0) == inside;
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
bool is_inside(const ElementFoot& foot, const Vector3& point) noexcept {
  if (foot.tile != nullptr) return foot.on_tile.below > 0;
  return foot.triangle_normal.dot(point - foot.on_triangle) < 0;
}

/// The kind of the surroundings of a point; `unknown` where there is no answer.
CubeKind kind_of(SpaceKind kind) noexcept {
  switch (kind) {
    case SpaceKind::told:
      return CubeKind::told;
    case SpaceKind::inside:
      return CubeKind::inside;
    case SpaceKind::outside:
      return CubeKind::outside;
    default:
      return CubeKind::unknown;
  }
}

/// Sets the answer from the nearest closest point, and from the one whose direction counts.
void set_answer(const AssetView& asset, const ElementFoot& nearest, const ElementFoot& foot,
                const Vector3& point, bool inside, Answer& answer) noexcept {
  if (!std::isfinite(nearest.distance)) {
    answer = unanswered(Status::far);
    return;
  }
  answer.distance = inside ? -nearest.distance : nearest.distance;
  answer.normal = normal_of(asset, foot, point, inside);
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
  const bool told = kind == CubeKind::told;
  const bool inside = told ? reading.sides.inside() : kind == CubeKind::inside;
  const ElementFoot& nearest = reading.nearest;
  const bool faced =
      reading.facing.distance <= nearest.distance + facing_tolerances * asset.tolerance;
  set_answer(asset, nearest, faced ? reading.facing : nearest, point, inside, answer);
  if (told && answer.status == Status::exact) answer.distance = told_distance(asset, reading);
}

/// Answers from the closest points on a list's primitives, in a place whose side is not known
/// beforehand.
void set_listed(const AssetView& asset, const ListedFeet& feet, const Vector3& point, CubeKind kind,
                Answer& answer) noexcept {
  const ElementFoot& foot = feet.faced();
  const bool inside =
      kind == CubeKind::one_sheet ? is_inside(foot, point) : kind == CubeKind::inside;
  set_answer(asset, feet.nearest, foot, point, inside, answer);
}

/// Returns the distance of the surface, as in AnswerAndDistance.
double query_sparse(const AssetView& asset, const IndexList& list, const Vector3& point,
                    Answer& answer) noexcept {
  CubeKind kind = list.kind;
  if (kind == CubeKind::unknown || kind == CubeKind::beside) {
    const SpaceKind space = space_at(asset.space, point);
    const bool is_solid = space == SpaceKind::inside;
    kind = kind == CubeKind::unknown || is_solid ? kind_of(space) : CubeKind::unknown;
    if (kind == CubeKind::unknown) {
      answer = unanswered(space == SpaceKind::pruned ? Status::pruned : Status::far);
      return -1;
    }
  }
  if (kind == CubeKind::far) {
    answer = unanswered(Status::far);
    return -1;
  }
  if (list.numbers == nullptr || kind == CubeKind::told) {
    query_elements(asset, list, point, kind, answer);
    return -1;
  }
  const ListedFeet feet = listed_feet(asset, list, point);
  set_listed(asset, feet, point, kind, answer);
  return feet.nearest.distance;
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
  std::array<GroupNames, points_at_once> names;
  std::array<std::array<float, 3>, points_at_once> places;
  std::array<std::size_t, points_at_once> listed, others;
  std::array<NearestUnit, points_at_once> found;
  std::size_t count = 0, rest = 0;
  lists_at(asset.index, points, lists.data());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const IndexList& list = lists[i];
    const bool by_list =
        list.numbers != nullptr && list.kind != CubeKind::told && list.kind != CubeKind::unknown;
    others[rest] = i;
    rest += by_list ? 0 : 1;
    listed[count] = i;
    names[count] = names_of(asset.index, list, list.nearest);
    places[count] = from_origin(asset.tree, points[i]);
    count += by_list ? 1 : 0;
  }
  nearest_units(asset.index.groups, std::span(names).first(count), std::span(places).first(count),
                std::span(found).first(count));
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = listed[k];
    answers[i] = {};
    set_listed(asset, listed_feet(asset, lists[i], points[i], found[k]), points[i], lists[i].kind,
               answers[i]);
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
