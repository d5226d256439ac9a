// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "common/base/vector.hpp"

namespace spm {

/// The damping, N s/m, that takes from a hand the energy that a sampled spring of stiffness K (N/m)
/// gives it: share K (1/2 + d) T. The zero-order hold leaks K T / 2 (Colgate and Schenkel 1997: b >
/// K T / 2). A delay of d ticks of length T (s), which includes an actuator's lag, leaks another d
/// K T. A `share` of 1 takes all of it.
[[nodiscard]] constexpr double matched_damping(double share, double stiffness, double delay_ticks,
                                               double tick) noexcept {
  return share * stiffness * (0.5 + delay_ticks) * tick;
}

/// The largest damping, N s/m, for a device whose moving mass is `mass` (kg): 0.25 m / T. A larger
/// damping answers a velocity of the tick before with a force that reverses it.
[[nodiscard]] constexpr double max_damping(double mass, double tick) noexcept {
  return 0.25 * mass / tick;
}

/// The same if the damping's force acts after a mean delay of some ticks (1/2 plus the delay): at
/// most 0.6 m over that time. At pi/2 a damping alone makes the device oscillate.
[[nodiscard]] constexpr double max_damping(double mass, double tick, double delay_ticks) noexcept {
  return std::min(max_damping(mass, tick), 0.6 * mass / ((0.5 + delay_ticks) * tick));
}

/// The reaction above which a braking force acts fully, in N and in encoder steps of the spring.
/// Otherwise the first steps would be felt as a knock.
inline constexpr double full_braking_reaction = 0.2, full_braking_steps = 6;

/// The fraction, 0 to 1, of a braking force (its magnitude, N) that within_reaction adds to a
/// reaction (N).
[[nodiscard]] double braking_share(double braking, double reaction,
                                   double full_from = full_braking_reaction) noexcept;

/// The part of a braking force (N) that is added to a reaction (N). It fades in with the reaction
/// and is complete from `full_from` (N) on. It is never larger than the reaction, so that touching
/// and leaving make no step and a hand that leaves is not held. Zero if an argument is not finite.
[[nodiscard]] Vector3 within_reaction(const Vector3& braking, double reaction,
                                      double full_from = full_braking_reaction) noexcept;

/// The same for the component along the reaction only: the leaking spring acts in that direction,
/// and a hand that slides is not held.
[[nodiscard]] Vector3 along_reaction(const Vector3& braking, const Vector3& reaction,
                                     double full_from = full_braking_reaction) noexcept;

}  // namespace spm
