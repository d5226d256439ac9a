// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "common/base/vector.hpp"

namespace spm {

/// Bounds how fast the direction of a penalty turns from tick to tick. The surface of an asset is
/// off by up to its tolerance, and so the creases of its patches, and the places where one feature
/// is as near as another, lie a little beside the mesh's: there the direction jumps by angles that
/// nothing of the mesh explains. What turns farther than `jump` is taken at once: then the side
/// itself changed; and so is any turn where the probe went farther than `step` in the tick, which
/// no hand does. Its force is no energy's: on a closed path through a limited turn it may gain.
struct TurnLimit {
  double rate = 0;     ///< rad/s, 0 or more; 0 is off
  double jump = 0.6;   ///< rad, 0 or more
  double step = 1e-3;  ///< m, 0 or more
};

/// The rate that the servo takes where nothing else is said, rad/s.
inline constexpr double usual_turn_rate = 120;

/// The unit vector `most` rad from `from` towards `to`, both unit; `to` itself where that is no
/// farther, or farther than `jump`. Never NaN for unit vectors.
[[nodiscard]] inline Vector3 limited_turn(const Vector3& from, const Vector3& to, double most,
                                          double jump) noexcept {
  const Vector3 across = to - to.dot(from) * from;
  const double sine = across.norm();
  const double angle = std::atan2(sine, to.dot(from));
  if (!(angle > most) || angle > jump || !(sine > 0)) return to;
  return (std::cos(most) * from + std::sin(most) / sine * across).normalized();
}

}  // namespace spm
