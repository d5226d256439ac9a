// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/corner_distances.hpp"

namespace spm::baker {

namespace {

/// The vectors from one point to each corner.
struct CornerVectors {
  CornerValues x, y, z;

  [[nodiscard]] CornerValues dot(const Vector3& v) const { return x * v[0] + y * v[1] + z * v[2]; }
  [[nodiscard]] CornerValues squared_less(const CornerValues& share, const Vector3& along) const {
    return (x - share * along[0]).square() + (y - share * along[1]).square() +
           (z - share * along[2]).square();
  }
};

CornerVectors from(const Vector3& point, const Vector3& middle, double half) {
  const Vector3 to_middle = middle - point;
  return {linear_at_corners(to_middle[0], {half, 0, 0}),
          linear_at_corners(to_middle[1], {0, half, 0}),
          linear_at_corners(to_middle[2], {0, 0, half})};
}

CornerValues squared_to_segment(const CornerVectors& from_start, const Vector3& along) {
  const double squared = along.squaredNorm();
  const CornerValues share = squared > 0
                                 ? CornerValues((from_start.dot(along) / squared).max(0.0).min(1.0))
                                 : CornerValues::Zero();
  return from_start.squared_less(share, along);
}

}  // namespace

CornerValues linear_at_corners(double value, const Vector3& rise) {
  CornerValues values;
  values << value - rise[0] - rise[1] - rise[2], value + rise[0] - rise[1] - rise[2],
      value - rise[0] + rise[1] - rise[2], value + rise[0] + rise[1] - rise[2],
      value - rise[0] - rise[1] + rise[2], value + rise[0] - rise[1] + rise[2],
      value - rise[0] + rise[1] + rise[2], value + rise[0] + rise[1] + rise[2];
  return values;
}

CornerValues corner_distances(const std::array<Vector3, 3>& triangle, const Vector3& middle,
                              double half) {
  const Vector3& a = triangle[0];
  const Vector3 ab = triangle[1] - a, ac = triangle[2] - a;
  const CornerVectors from_a = from(a, middle, half);
  const CornerVectors from_b = from(triangle[1], middle, half);
  CornerValues squares = squared_to_segment(from_a, ab)
                             .min(squared_to_segment(from_a, ac))
                             .min(squared_to_segment(from_b, triangle[2] - triangle[1]));
  const Vector3 normal = ab.cross(ac);
  const double area = normal.squaredNorm();
  if (!(area > 0)) return squares.sqrt();
  // Barycentric coordinates of the projections.
  const CornerValues weight_b = from_a.dot(Vector3(ac.cross(normal) / area));
  const CornerValues weight_c = from_a.dot(Vector3(normal.cross(ab) / area));
  const CornerValues on_face = (from_a.x - weight_b * ab[0] - weight_c * ac[0]).square() +
                               (from_a.y - weight_b * ab[1] - weight_c * ac[1]).square() +
                               (from_a.z - weight_b * ab[2] - weight_c * ac[2]).square();
  const CornerValues least = weight_b.min(weight_c).min(1 - weight_b - weight_c);
  squares = (least >= 0).select(on_face, squares);
  return squares.sqrt();
}

}  // namespace spm::baker
