// SPDX-License-Identifier: Apache-2.0
#include "common/surface/support_plane_mapping.hpp"

namespace spm {

std::size_t support_plane_mapping(std::span<const SupportPlane> planes,
                                  const Vector3& direction) noexcept {
  std::size_t best = 0;
  double best_alignment = planes[0].n.dot(direction);
  for (std::size_t i = 1; i < planes.size(); ++i) {
    const double alignment = planes[i].n.dot(direction);
    if (alignment > best_alignment) {
      best_alignment = alignment;
      best = i;
    }
  }
  return best;
}

std::size_t support_mapping(std::span<const Vector3> points, const Vector3& direction) noexcept {
  std::size_t best = 0;
  double farthest = points[0].dot(direction);
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double distance = points[i].dot(direction);
    if (distance > farthest) {
      farthest = distance;
      best = i;
    }
  }
  return best;
}

SupportPlane vertex_support_plane(std::span<const Vector3> points, const Vector3& normal) noexcept {
  return plane_with_normal(points[support_mapping(points, normal)], normal);
}

SupportPlane plane_with_normal(const Vector3& x0, const Vector3& normal) noexcept {
  // Duff et al., "Building an Orthonormal Basis, Revisited" (JCGT 2017): no cancellation for any
  // unit normal, one branch on the sign of z.
  const double sign = normal.z() < 0 ? -1.0 : 1.0;
  const double a = -1.0 / (sign + normal.z());
  const double b = normal.x() * normal.y() * a;
  SupportPlane plane;
  plane.x0 = x0;
  plane.u = Vector3(1.0 + sign * normal.x() * normal.x() * a, sign * b, -sign * normal.x());
  plane.v = Vector3(b, sign + normal.y() * normal.y() * a, -normal.y());
  plane.n = normal;
  return plane;
}

bool in_bounded_space(std::span<const SupportPlane> planes, const Vector3& point,
                      double slack) noexcept {
  for (const SupportPlane& plane : planes) {
    if (support_plane_depth(plane, point) < -slack) return false;
  }
  return true;
}

}  // namespace spm
