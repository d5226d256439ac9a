// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/geometry/swept_triangle.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "common/surface/closest_on_triangle.hpp"

namespace spm::bench {
namespace {

constexpr int max_steps = 12;

/// Whether a point in the plane of the triangle is inside it or at most `slack` metres outside.
bool inside(const Vector3& point, const std::array<Vector3, 3>& corners, const Vector3& normal,
            double slack) noexcept {
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3 edge = corners[(k + 1) % 3] - corners[k];
    const double beside = normal.cross(edge).dot(point - corners[k]);
    if (beside < 0 && beside * beside > slack * slack * edge.squaredNorm()) return false;
  }
  return true;
}

}  // namespace

bool touch_by_point(const Vector3& from, const Vector3& move, const std::array<Vector3, 3>& corners,
                    double skin, Touch& touch) noexcept {
  const Vector3 across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  const double start = across.dot(from - corners[0]);
  const double change = across.dot(move);
  // The point crosses the plane if the two have different signs and the change is larger.
  if (start > 0 ? start + change > 0 : start + change < 0) return false;
  if (change == 0) return false;
  const double share = std::clamp(-start / change, 0.0, 1.0);
  const double area = across.norm();
  const Vector3 normal = across / area;
  const Vector3 closest_point = from + share * move;
  // Neighbours overlap by a thousandth of the skin, so that no point slips between them.
  if (!inside(closest_point, corners, normal, 1e-3 * skin)) return false;
  // Move back until the point is one skin above the plane, or at its start.
  touch.share = std::max(0.0, share - skin * area / std::abs(change));
  touch.closest_point = closest_point;
  touch.normal = start > 0 ? normal : Vector3(-normal);
  return true;
}

bool touch_by_ball(const Vector3& from, const Vector3& move, double radius,
                   const std::array<Vector3, 3>& corners, double skin, Touch& touch) noexcept {
  // The distance to a convex set is convex along the move, so that Newton's steps from its start
  // never pass the place where it falls below half a skin. What goes by at a whole skin, such as
  // over the seam of two triangles, comes to no such place.
  const double reach = radius + skin / 2;
  double share = 0;
  for (int step = 0; step < max_steps; ++step) {
    const Vector3 place = from + share * move;
    touch.closest_point = closest_on_triangle(place, corners[0], corners[1], corners[2]);
    const Vector3 away = place - touch.closest_point;
    const double distance = away.norm();
    if (!(distance > 0)) return false;
    touch.normal = away / distance;
    const double slope = touch.normal.dot(move);
    const double gap = distance - reach;
    if (slope >= 0) return false;
    // Move back until the gap is a whole skin, or to the start of the move.
    touch.share = std::max(0.0, share + skin / 2 / slope);
    if (gap <= 0.01 * skin) return true;
    share -= gap / slope;
    if (share > 1) return false;
  }
  return true;
}

}  // namespace spm::bench
