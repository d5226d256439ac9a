// SPDX-License-Identifier: Apache-2.0
#include "common/culling/hull_distance.hpp"

#include "common/surface/closest_on_triangle.hpp"

namespace spm {

bool NearestSimplex::add(const Vector3& point) noexcept {
  if (count_ == 3) return add_fourth(point);
  points_[count_++] = point;
  const Vector3 before = nearest_;
  const Vector3& third = count_ == 3 ? points_[2] : points_[1];
  nearest_ = closest_on_triangle(Vector3::Zero(), points_[0], points_[1], third);
  return nearest_.squaredNorm() < before.squaredNorm();
}

bool NearestSimplex::add_fourth(const Vector3& point) noexcept {
  points_[3] = point;
  const double before = nearest_.squaredNorm();
  double best = before;
  std::size_t dropped = 4;
  around_ = true;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vector3 &a = points_[(k + 1) % 4], &b = points_[(k + 2) % 4], &c = points_[(k + 3) % 4];
    const Vector3 normal = (b - a).cross(c - a);
    // The origin and the fourth point lie on two sides of a face: the origin is not surrounded.
    if (!(normal.dot(-a) * normal.dot(points_[k] - a) > 0)) around_ = false;
    if (k == 3) continue;  // the face that was there before
    const Vector3 nearest = closest_on_triangle(Vector3::Zero(), a, b, c);
    if (!(nearest.squaredNorm() < best)) continue;
    best = nearest.squaredNorm();
    nearest_ = nearest;
    dropped = k;
  }
  if (around_) return true;
  if (dropped == 4) return false;
  points_[dropped] = points_[3];
  return true;
}

}  // namespace spm
