// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/planes/linear_program.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

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

}  // namespace

void shuffle(std::vector<HalfSpace>& constraints, std::uint64_t seed) {
  // Not std::shuffle, which uses the random numbers differently in different standard libraries.
  std::mt19937_64 random(seed);
  for (std::size_t i = constraints.size(); i > 1; --i) {
    std::swap(constraints[i - 1], constraints[random() % i]);
  }
}

std::optional<Vector3> maximise(const std::vector<HalfSpace>& constraints, const Vector3& objective,
                                double bound) {
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

}  // namespace spm::baker
