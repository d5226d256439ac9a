// SPDX-License-Identifier: Apache-2.0
#include "common/surface/closest_on_triangle.hpp"

#include <algorithm>

namespace spm {

namespace {

/// A vector whose parts stay in registers: of Vector3, a part that was just written and is read
/// with another one waits for memory.
struct Parts {
  double x = 0, y = 0, z = 0;
};

Parts parts_of(const Vector3& v) noexcept { return {v[0], v[1], v[2]}; }
Parts operator-(const Parts& a, const Parts& b) noexcept {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Parts operator*(double s, const Parts& a) noexcept { return {s * a.x, s * a.y, s * a.z}; }
double dot(const Parts& a, const Parts& b) noexcept { return a.x * b.x + a.y * b.y + a.z * b.z; }
Parts cross(const Parts& a, const Parts& b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The share of a side's way at which it is closest; `way` leads from its first end to the point.
double share_of(const Parts& way, const Parts& along) noexcept {
  const double squared = dot(along, along);
  const double share = squared > 0 ? dot(along, way) / squared : 0;
  return std::min(std::max(share, 0.0), 1.0);
}

}  // namespace

// All sides are looked at, and the nearest one is chosen at the end: which one that is cannot be
// foretold, and a wrong guess of the processor takes longer than the sides do.
ClosestFeature closest_feature(const Vector3& point, const Vector3& a, const Vector3& b,
                               const Vector3& c) noexcept {
  const Parts p = parts_of(point), first = parts_of(a);
  const Parts ab = parts_of(b) - first, ac = parts_of(c) - first, ap = p - first;
  const Parts normal = cross(ab, ac);
  ClosestFeature closest;
  closest.normal = {normal.x, normal.y, normal.z};
  const double squared = dot(normal, normal);
  // Barycentric coordinates of the projection decide whether the face itself is closest.
  const double weight_c = dot(cross(ab, ap), normal), weight_b = dot(cross(ap, ac), normal);
  if (squared > 0 && weight_b >= 0 && weight_c >= 0 && weight_b + weight_c <= squared) {
    const double share_b = weight_b / squared, share_c = weight_c / squared;
    closest.point = {first.x + share_b * ab.x + share_c * ac.x,
                     first.y + share_b * ab.y + share_c * ac.y,
                     first.z + share_b * ab.z + share_c * ac.z};
    return closest;
  }
  const Parts bc = ac - ab, bp = ap - ab, cp = ap - ac, ca = -1.0 * ac;
  const double on_ab = share_of(ap, ab), on_bc = share_of(bp, bc), on_ca = share_of(cp, ca);
  const Parts off_ab = ap - on_ab * ab, off_bc = bp - on_bc * bc, off_ca = cp - on_ca * ca;
  const double to_ab = dot(off_ab, off_ab), to_bc = dot(off_bc, off_bc),
               to_ca = dot(off_ca, off_ca);
  const bool second = to_bc < to_ab, third = to_ca < (second ? to_bc : to_ab);
  const Parts off = third ? off_ca : second ? off_bc : off_ab;
  const double share = third ? on_ca : second ? on_bc : on_ab;
  closest.point = {p.x - off.x, p.y - off.y, p.z - off.z};
  // Sides, and corners after them, stand in turn in TriangleFeature.
  const unsigned side = third ? 2 : second ? 1 : 0, end = third ? 0 : side + 1;
  const unsigned corner = static_cast<unsigned>(TriangleFeature::a) + (share > 0 ? end : side);
  const bool within = share > 0 && share < 1;
  closest.feature = static_cast<TriangleFeature>(
      within ? static_cast<unsigned>(TriangleFeature::ab) + side : corner);
  return closest;
}

Vector3 closest_on_triangle(const Vector3& point, const Vector3& a, const Vector3& b,
                            const Vector3& c) noexcept {
  return closest_feature(point, a, b, c).point;
}

}  // namespace spm
