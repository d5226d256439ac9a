// SPDX-License-Identifier: Apache-2.0
#include "common/surface/closest_on_triangle.hpp"

#include <algorithm>

namespace spm {

namespace {

/// Closest point on a segment, and the feature that it lies on: of the segment itself, of its first
/// end or of its second.
ClosestFeature closest_on_segment(const Vector3& point, const Vector3& a, const Vector3& b,
                                  TriangleFeature side, TriangleFeature first,
                                  TriangleFeature second) noexcept {
  const Vector3 along = b - a;
  const double squared = along.squaredNorm();
  const double share = squared > 0 ? along.dot(point - a) / squared : 0;
  if (!(share > 0)) return {a, first};
  if (share >= 1) return {b, second};
  return {a + share * along, side};
}

}  // namespace

ClosestFeature closest_feature(const Vector3& point, const Vector3& a, const Vector3& b,
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
      return {a + weight_b * ab + weight_c * ac, TriangleFeature::face};
    }
  }
  ClosestFeature best =
      closest_on_segment(point, a, b, TriangleFeature::ab, TriangleFeature::a, TriangleFeature::b);
  for (const ClosestFeature& other : {closest_on_segment(point, b, c, TriangleFeature::bc,
                                                         TriangleFeature::b, TriangleFeature::c),
                                      closest_on_segment(point, c, a, TriangleFeature::ca,
                                                         TriangleFeature::c, TriangleFeature::a)}) {
    if ((other.point - point).squaredNorm() < (best.point - point).squaredNorm()) best = other;
  }
  return best;
}

Vector3 closest_on_triangle(const Vector3& point, const Vector3& a, const Vector3& b,
                            const Vector3& c) noexcept {
  return closest_feature(point, a, b, c).point;
}

}  // namespace spm
