// SPDX-License-Identifier: Apache-2.0
#include "common/surface/closest_on_triangle.hpp"

#include <algorithm>

namespace spm {

namespace {

Vector3 closest_on_segment(const Vector3& point, const Vector3& a, const Vector3& b) noexcept {
  const Vector3 along = b - a;
  const double squared = along.squaredNorm();
  if (!(squared > 0)) return a;
  return a + std::clamp(along.dot(point - a) / squared, 0.0, 1.0) * along;
}

}  // namespace

Vector3 closest_on_triangle(const Vector3& point, const Vector3& a, const Vector3& b,
                            const Vector3& c) noexcept {
  const Vector3 ab = b - a;
  const Vector3 ac = c - a;
  const Vector3 normal = ab.cross(ac);
  const double squared = normal.squaredNorm();
  if (squared > 0) {
    // Barycentric coordinates of the projection decide whether the face itself is closest.
    const Vector3 ap = point - a;
    const double weight_c = ab.cross(ap).dot(normal) / squared;
    const double weight_b = ap.cross(ac).dot(normal) / squared;
    if (weight_b >= 0 && weight_c >= 0 && weight_b + weight_c <= 1) {
      return a + weight_b * ab + weight_c * ac;
    }
  }
  Vector3 best = closest_on_segment(point, a, b);
  for (const Vector3& other : {closest_on_segment(point, b, c), closest_on_segment(point, c, a)}) {
    if ((other - point).squaredNorm() < (best - point).squaredNorm()) best = other;
  }
  return best;
}

}  // namespace spm
