// SPDX-License-Identifier: Apache-2.0
#include "common/query/triangle_side.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

namespace spm {

namespace {

/// A closest point this near to a corner, relative to the shorter side squared, is at the corner.
constexpr double corner_share = 1e-14;

}  // namespace

IncidentSector incident_sector(const std::array<Vector3, 3>& corners, const Vector3& closest_point,
                               bool within) noexcept {
  if (within) return {2 * std::numbers::pi, Vector3::Zero()};
  // The closest point lies on the side between whose ends it is the smallest detour.
  std::size_t side = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3 next = corners[(k + 1) % 3] - corners[k];
    const Vector3 last = corners[(k + 2) % 3] - corners[k];
    const double most = corner_share * std::min(next.squaredNorm(), last.squaredNorm());
    if ((closest_point - corners[k]).squaredNorm() <= most) {
      return {std::atan2(next.cross(last).norm(), next.dot(last)),
              next.normalized() - last.normalized()};
    }
    const double detour = (corners[k] - closest_point).norm() +
                          (corners[(k + 1) % 3] - closest_point).norm() - next.norm();
    if (detour < least) {
      least = detour;
      side = k;
    }
  }
  return {std::numbers::pi, 2 * (corners[(side + 1) % 3] - corners[side]).normalized()};
}

}  // namespace spm
