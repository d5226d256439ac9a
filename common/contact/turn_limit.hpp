// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "common/base/vector.hpp"

namespace spm {

/// Limits how fast the direction of a penalty force turns from tick to tick.
///
/// The surface of an asset is off by up to its tolerance. So the creases of its patches, and the
/// places where two features are equally near, lie slightly beside those of the mesh. There the
/// direction jumps by angles that the mesh does not explain. A turn larger than `jump` is taken at
/// once, because then the side itself changed. So is any turn in a tick where the probe moved
/// farther than `step`, which no hand does. A limited force has no potential: on a closed path
/// through a limited turn it may give energy.
struct TurnLimit {
  double rate = 0;     ///< rad/s, 0 or more; 0 is off
  double jump = 0.6;   ///< rad, 0 or more
  double step = 1e-3;  ///< m, 0 or more
};

/// The servo's default rate, rad/s.
inline constexpr double default_turn_rate = 120;

/// The unit vector `max_angle` rad from `from` towards `to`, both unit; `to` itself where its angle
/// is not more than `max_angle`, or more than `jump`. Never NaN for unit vectors.
[[nodiscard]] inline Vector3 limited_turn(const Vector3& from, const Vector3& to, double max_angle,
                                          double jump) noexcept {
  const Vector3 across = to - to.dot(from) * from;
  const double sine = across.norm();
  const double angle = std::atan2(sine, to.dot(from));
  if (!(angle > max_angle) || angle > jump || !(sine > 0)) return to;
  return (std::cos(max_angle) * from + std::sin(max_angle) / sine * across).normalized();
}

}  // namespace spm
