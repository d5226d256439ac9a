// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/vector.hpp"

namespace spm {

/// Parameters of friction; all finite.
struct FrictionSettings {
  double stick = 0;      ///< mu at rest, 0 or more; raised to `slide` where it is less
  double slide = 0;      ///< mu in motion, 0 or more
  double stiffness = 0;  ///< N/m, of the spring that holds the point while it sticks, above 0
};

/// The state of friction from tick to tick.
struct FrictionState {
  bool held = false;  ///< there was contact in the last tick
  bool sliding = false;
  Vector3 anchor = Vector3::Zero();  ///< m, object's frame: the place where friction would be zero
};

/// Coulomb friction with stick and slip, N, tangential to the surface. Advances the state by one
/// tick.
///
/// While the point sticks it hangs on a spring from its anchor. Where the spring would pull with
/// more than mu at rest times the normal force, the point slides: the anchor follows, so that the
/// spring pulls with mu in motion times the normal force. The point sticks again where the spring
/// pulls with less. So the force never exceeds mu N. It does no work on a closed path that sticks.
/// At rest it is as quiet as the position is: noise changes the force by stiffness times noise, and
/// never reverses it.
///
/// `point` in m and the outward unit `normal` are in the object's frame, so that an object that
/// moves takes its anchor along. `pressing` is the normal force in N; where it is not above 0 there
/// is no contact, and the point is released. The anchor is kept in the tangent plane through the
/// point. (A spring from a sliding anchor: Salcudean and Vlaar 1997, Hayward and Armstrong 2000.)
[[nodiscard]] Vector3 coulomb_friction(const FrictionSettings& settings, const Vector3& point,
                                       const Vector3& normal, double pressing,
                                       FrictionState& state) noexcept;

}  // namespace spm
