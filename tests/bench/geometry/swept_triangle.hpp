// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "common/base/vector.hpp"

namespace spm::bench {

/// Where a moving point or ball first touches a triangle.
struct Touch {
  double share = 0;                         ///< of the move, 0 to 1
  Vector3 closest_point = Vector3::Zero();  ///< on the triangle
  Vector3 normal = Vector3::Zero();         ///< unit, towards the moving point or ball
};

/// First touch of a point moving from `from` by `move`, from either side of the triangle; it stops
/// `skin` metres above it. False if the point misses the triangle.
[[nodiscard]] bool touch_by_point(const Vector3& from, const Vector3& move,
                                  const std::array<Vector3, 3>& corners, double skin,
                                  Touch& touch) noexcept;

/// The same for a ball of `radius` metres, against the triangle's face, edges and corners.
[[nodiscard]] bool touch_by_ball(const Vector3& from, const Vector3& move, double radius,
                                 const std::array<Vector3, 3>& corners, double skin,
                                 Touch& touch) noexcept;

}  // namespace spm::bench
