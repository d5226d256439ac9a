// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/planes/planes.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include "baker/base/bake_error.hpp"
#include "common/base/half_space.hpp"
#include "common/surface/support_plane_mapping.hpp"

namespace spm::baker {
namespace {

using Vector2 = Eigen::Vector2d;

constexpr double kTolerance = 1e-13;  ///< of the coordinates' size
constexpr double kParallel = 1e-12;   ///< sine of the angle below which two normals are parallel

struct HalfPlane {
  Vector2 normal = Vector2::UnitX();
  double offset = 0;
};

/// The interval of t in which origin + t * along satisfies the half-planes seen so far. The loose
/// ends allow each half-plane its tolerance. They alone decide that the interval is empty.
struct Interval {
  double low, high, loose_low, loose_high;

  /// Adds slope * t <= room; false where nothing is left.
  [[nodiscard]] bool clip(double slope, double room, double tolerance) {
    if (std::abs(slope) < kParallel) return room >= -tolerance;
    const double end = room / slope;
    const double loose = (room + tolerance) / slope;
    if (slope > 0) {
      high = std::min(high, end);
      loose_high = std::min(loose_high, loose);
    } else {
      low = std::max(low, end);
      loose_low = std::max(loose_low, loose);
    }
    return loose_low <= loose_high;
  }

  [[nodiscard]] double farthest(double slope) const {
    if (low > high) return (low + high) / 2;
    return slope >= 0 ? high : low;
  }
};

/// The farthest point on the line of half-plane `which` within the half-planes before it.
[[nodiscard]] std::optional<Vector2> maximise_on_line(const std::vector<HalfPlane>& constraints,
                                                      std::size_t which, const Vector2& objective,
                                                      double bound, double tolerance) {
  const HalfPlane& line = constraints[which];
  const Vector2 origin = line.offset * line.normal;
  const Vector2 along(-line.normal.y(), line.normal.x());
  Interval interval{-bound, bound, -bound, bound};
  for (std::size_t i = 0; i < which; ++i) {
    const double room = constraints[i].offset - constraints[i].normal.dot(origin);
    if (!interval.clip(constraints[i].normal.dot(along), room, tolerance)) return std::nullopt;
  }
  return origin + interval.farthest(objective.dot(along)) * along;
}

/// Two variables, |x_k| <= bound; the caller has shuffled the constraints.
[[nodiscard]] std::optional<Vector2> maximise_in_plane(const std::vector<HalfPlane>& constraints,
                                                       const Vector2& objective, double bound,
                                                       double tolerance) {
  Vector2 best(std::copysign(bound, objective.x()), std::copysign(bound, objective.y()));
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    const double slack = tolerance + kTolerance * best.lpNorm<1>();
    if (constraints[i].normal.dot(best) <= constraints[i].offset + slack) continue;
    const auto found = maximise_on_line(constraints, i, objective, 2 * bound, tolerance);
    if (!found) return std::nullopt;
    best = *found;
  }
  return best;
}

/// The farthest point on the plane of constraint `which` within the constraints before it.
[[nodiscard]] std::optional<Vector3> maximise_on_plane(const std::vector<HalfSpace>& constraints,
                                                       std::size_t which, const Vector3& objective,
                                                       double bound, double tolerance) {
  const SupportPlane plane = plane_with_normal(
      constraints[which].offset * constraints[which].normal, constraints[which].normal);
  std::vector<HalfPlane> lines;
  lines.reserve(which);
  for (std::size_t i = 0; i < which; ++i) {
    const Vector2 normal(constraints[i].normal.dot(plane.u), constraints[i].normal.dot(plane.v));
    const double room = constraints[i].offset - constraints[i].normal.dot(plane.x0);
    const double length = normal.norm();
    if (length < kParallel) {
      if (room < -tolerance) return std::nullopt;
      continue;
    }
    lines.push_back({normal / length, room / length});
  }
  const auto found = maximise_in_plane(lines, {objective.dot(plane.u), objective.dot(plane.v)},
                                       2 * bound, tolerance);
  if (!found) return std::nullopt;
  return plane.x0 + found->x() * plane.u + found->y() * plane.v;
}

/// Shuffles half-spaces in place, in an order that the seed fixes. The expected linear time of
/// `maximise` needs shuffled constraints.
void shuffle(std::vector<HalfSpace>& constraints, std::uint64_t seed) {
  // Not std::shuffle, which uses the random numbers differently in different standard libraries.
  std::mt19937_64 random(seed);
  for (std::size_t i = constraints.size(); i > 1; --i) {
    std::swap(constraints[i - 1], constraints[random() % i]);
  }
}

/// The point that lies farthest along `objective` within all half-spaces and the cube |x_k| <=
/// bound. Seidel's algorithm: the expected time is linear in the number of constraints, if they are
/// shuffled. The point may lie outside a constraint by about 1e-13 of the coordinates; a constraint
/// is never made tighter than it is. Empty where the half-spaces have no point in common within
/// that.
[[nodiscard]] std::optional<Vector3> maximise(const std::vector<HalfSpace>& constraints,
                                              const Vector3& objective, double bound) {
  double scale = 0;
  for (const HalfSpace& constraint : constraints) {
    scale = std::max(scale, std::abs(constraint.offset));
  }
  const double tolerance = kTolerance * scale;
  Vector3 best(std::copysign(bound, objective.x()), std::copysign(bound, objective.y()),
               std::copysign(bound, objective.z()));
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    const double slack = tolerance + kTolerance * best.lpNorm<1>();
    if (constraints[i].normal.dot(best) <= constraints[i].offset + slack) continue;
    const auto found = maximise_on_plane(constraints, i, objective, bound, tolerance);
    if (!found) return std::nullopt;
    best = *found;
  }
  return best;
}

constexpr std::size_t kDefaultPlanes = 1000;
constexpr std::size_t kFewestPlanes = 4;  ///< the least that can bound a space

/// A unit direction that no normal opposes, along which the planes' space is unbounded. Empty where
/// the normals positively span space.
[[nodiscard]] std::optional<Vector3> unbounded_direction(std::span<const Vector3> normals) {
  // With this tolerance a bounded cone ends near zero, and an unbounded one at the cube's side.
  constexpr double kRoom = 1e-7;
  std::vector<HalfSpace> cone;
  cone.reserve(normals.size());
  for (const Vector3& normal : normals) cone.push_back({normal, kRoom});
  shuffle(cone, normals.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      const Vector3 objective = sign * Vector3::Unit(axis);
      const auto farthest = maximise(cone, objective, 1.0);
      if (farthest && farthest->dot(objective) > 0.5) return farthest->normalized();
    }
  }
  return std::nullopt;
}

[[nodiscard]] std::vector<Vector3> normals_of(const Hull& hull,
                                              std::span<const std::size_t> chosen) {
  std::vector<Vector3> normals;
  normals.reserve(chosen.size());
  for (const std::size_t facet : chosen) normals.push_back(hull.facets[facet].normal);
  return normals;
}

/// A few facets whose planes bound the object, with `start` among the first considered. Empty where
/// the hull's facets do not bound it.
[[nodiscard]] std::vector<std::size_t> bounding_facets(const Hull& hull, std::size_t start) {
  std::vector<std::size_t> chosen{start};
  while (const auto open = unbounded_direction(normals_of(hull, chosen))) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < hull.facets.size(); ++i) {
      if (hull.facets[i].normal.dot(*open) > hull.facets[best].normal.dot(*open)) best = i;
    }
    if (std::find(chosen.begin(), chosen.end(), best) != chosen.end()) return {};
    chosen.push_back(best);
  }
  // The smallest are removed first, so that large facets stay.
  std::vector<std::size_t> by_area = chosen;
  std::stable_sort(by_area.begin(), by_area.end(), [&](std::size_t a, std::size_t b) {
    return hull.facets[a].area < hull.facets[b].area;
  });
  for (const std::size_t facet : by_area) {
    std::vector<std::size_t> rest = chosen;
    std::erase(rest, facet);
    if (!unbounded_direction(normals_of(hull, rest))) chosen = std::move(rest);
  }
  return chosen;
}

/// Adds facets up to `count`. Each time it takes the facet with the largest product of area and
/// distance in direction from those chosen so far.
void spread_facets(const Hull& hull, std::size_t count, std::vector<std::size_t>& chosen) {
  std::vector<double> distance(hull.facets.size(), 2.0);
  const auto take = [&](std::size_t facet) {
    for (std::size_t i = 0; i < hull.facets.size(); ++i) {
      const double gap = 1 - hull.facets[i].normal.dot(hull.facets[facet].normal);
      distance[i] = std::min(distance[i], std::max(gap, 0.0));
    }
    distance[facet] = -1;
  };
  for (const std::size_t facet : chosen) take(facet);
  while (chosen.size() < count) {
    std::size_t best = 0;
    double best_score = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < hull.facets.size(); ++i) {
      const double score = distance[i] < 0 ? -1 : hull.facets[i].area * distance[i];
      if (score > best_score) {
        best_score = score;
        best = i;
      }
    }
    chosen.push_back(best);
    take(best);
  }
}

[[nodiscard]] std::vector<std::size_t> choose_facets(const Hull& hull, std::size_t count) {
  constexpr std::size_t kStarts = 32;
  std::vector<std::size_t> chosen;
  for (std::size_t start = 0; start < std::min(kStarts, hull.facets.size()); ++start) {
    chosen = bounding_facets(hull, start);
    if (!chosen.empty() && chosen.size() <= count) break;
    chosen.clear();
  }
  spread_facets(hull, count, chosen);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

[[nodiscard]] BakeError usage(const std::string& message) { return {ExitCode::usage, message}; }

}  // namespace

std::vector<SupportPlane> face_based_planes(const Hull& hull, std::optional<std::size_t> count) {
  std::vector<SupportPlane> planes;
  if (!count || *count >= hull.facets.size()) {
    for (const HullFacet& facet : hull.facets) {
      planes.push_back(plane_with_normal(facet.point, facet.normal));
    }
    return planes;
  }
  for (const std::size_t facet : choose_facets(hull, *count)) {
    planes.push_back(plane_with_normal(hull.facets[facet].point, hull.facets[facet].normal));
  }
  return planes;
}

std::vector<SupportPlane> vertex_based_planes(const Hull& hull, std::size_t count) {
  std::vector<SupportPlane> planes;
  planes.reserve(count);
  for (const Vector3& normal : fibonacci_directions(count)) {
    planes.push_back(vertex_support_plane(hull.vertices, normal));
  }
  return planes;
}

std::vector<Vector3> fibonacci_directions(std::size_t count) {
  std::vector<Vector3> directions;
  directions.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1 - (2.0 * static_cast<double>(i) + 1) / static_cast<double>(count);
    const double turns = static_cast<double>(i) / std::numbers::phi;
    const double angle = 2 * std::numbers::pi * (turns - std::floor(turns));
    const double radius = std::sqrt(1 - z * z);
    directions.push_back(
        Vector3(radius * std::cos(angle), radius * std::sin(angle), z).normalized());
  }
  return directions;
}

SupportPlaneSet make_support_planes(const Hull& hull, PlaneKind kind,
                                    std::optional<std::size_t> count) {
  const std::size_t facets = hull.facets.size();
  if (count && *count < kFewestPlanes) {
    throw usage("--planes " + std::to_string(*count) +
                ": fewer than 4 planes cannot bound an object; ask for 4 or more");
  }
  if (kind == PlaneKind::automatic) {
    kind = count.value_or(facets) <= facets && (count || facets <= kDefaultPlanes)
               ? PlaneKind::face
               : PlaneKind::vertex;
  }
  SupportPlaneSet set;
  set.kind = kind;
  if (kind == PlaneKind::face) {
    if (count && *count > facets) {
      throw usage("--planes " + std::to_string(*count) + ": the convex hull has only " +
                  std::to_string(facets) + " distinct facets; ask for at most that many, or for " +
                  "--kind vertex");
    }
    set.planes = face_based_planes(hull, count);
  } else {
    set.planes = vertex_based_planes(hull, count.value_or(kDefaultPlanes));
  }
  if (!fully_bounding(set.planes)) {
    throw usage("--planes " + std::to_string(set.planes.size()) +
                ": so few planes do not bound this object on all sides; ask for more");
  }
  return set;
}

bool fully_bounding(std::span<const SupportPlane> planes) {
  if (planes.size() < kFewestPlanes) return false;
  std::vector<Vector3> normals;
  normals.reserve(planes.size());
  for (const SupportPlane& plane : planes) normals.push_back(plane.n);
  return !unbounded_direction(normals);
}

Rectangle own_region(std::span<const SupportPlane> planes, std::size_t which) {
  constexpr double kSameNormal = 1e-9;  // planes closer than this tie everywhere
  constexpr double kFar = 1e4;          // farther than any bounded space worth the name reaches
  constexpr double kMargin = 1e-6;      // of the rectangle's size, against rounding
  const SupportPlane& own = planes[which];
  // Unknowns are eta, omega and the depth below the own plane. The half-spaces of the other planes
  // are not needed: a point below this plane and no closer to another plane lies below that plane
  // too.
  std::vector<HalfSpace> closer{{-Vector3::UnitZ(), 0}};
  double scale = 0;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const Vector3 normal = planes[i].n - own.n;
    const double length = normal.norm();
    const Vector3 offset = planes[i].x0 - own.x0;
    scale = std::max(scale, offset.norm());
    if (i == which || length < kSameNormal) continue;
    const Vector3 local(normal.dot(own.u), normal.dot(own.v), -normal.dot(own.n));
    closer.push_back({local / length, planes[i].n.dot(offset) / length});
  }
  shuffle(closer, which);
  std::array<double, 4> ends{};
  for (std::size_t side = 0; side < 4; ++side) {
    const int axis = static_cast<int>(side / 2);
    const Vector3 objective = (side % 2 == 0 ? -1.0 : 1.0) * Vector3::Unit(axis);
    const auto farthest = maximise(closer, objective, kFar * scale);
    if (!farthest) return {0, -1, 0, -1};
    ends[side] = (*farthest)[axis];
  }
  const double margin = kMargin * std::max({ends[1] - ends[0], ends[3] - ends[2], 1e-3 * scale});
  return {ends[0] - margin, ends[1] + margin, ends[2] - margin, ends[3] + margin};
}

}  // namespace spm::baker
