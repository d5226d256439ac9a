// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/vector.hpp"

namespace spm {

/// How friction feels; all finite.
struct FrictionSettings {
  double stick = 0;      ///< mu at rest, 0 or more; taken to be at least `slide`
  double slide = 0;      ///< mu in motion, 0 or more
  double stiffness = 0;  ///< N/m, of what holds the point while it sticks, above 0
};

/// What friction remembers from tick to tick.
struct FrictionState {
  bool held = false;  ///< there was contact in the last tick
  bool sliding = false;
  Vector3 anchor = Vector3::Zero();  ///< m, object's frame: where the point would feel no friction
};

/// Coulomb friction with stick and slip, N, tangential to the surface; moves the state on by a
/// tick.
///
/// While it sticks the point hangs on a spring from its anchor. Where the spring would pull with
/// more than mu at rest times the force that presses, it slides: the anchor follows, so that it
/// pulls with mu in motion times that. It sticks again where the spring pulls with less. So the
/// force never exceeds mu N, does no work on a closed path that sticks, and at rest is as quiet as
/// the position is: noise moves the force by stiffness times noise, and never turns it round.
///
/// `point` in m and the outward unit `normal` in the object's frame, so that an object that moves
/// takes its anchor along; `pressing` in N, what is not above 0 is no contact and lets go. The
/// anchor is kept in the tangent plane through the point. (A spring from an anchor that slides:
/// Salcudean and Vlaar 1997, Hayward and Armstrong 2000.)
[[nodiscard]] Vector3 coulomb_friction(const FrictionSettings& settings, const Vector3& point,
                                       const Vector3& normal, double pressing,
                                       FrictionState& state) noexcept;

}  // namespace spm
