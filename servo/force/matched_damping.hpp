// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "common/base/vector.hpp"

namespace spm {

/// The damping, N s/m, that takes from a hand what a sampled spring of stiffness K (N/m) gives it:
/// share K (1/2 + d) T. The zero-order hold leaks K T / 2 (Colgate and Schenkel 1997: b > K T / 2),
/// a delay of d ticks of length T (s), an actuator's lag among them, another d K T; a share of 1 is
/// all of it.
[[nodiscard]] constexpr double matched_damping(double share, double stiffness, double delay_ticks,
                                               double tick) noexcept {
  return share * stiffness * (0.5 + delay_ticks) * tick;
}

/// The most that may be damped, N s/m, of a device of so much moving mass (kg): 0.25 m / T. More
/// answers a velocity of the tick before with a force that turns it round.
[[nodiscard]] constexpr double most_damping(double mass, double tick) noexcept {
  return 0.25 * mass / tick;
}

/// The same where the damping's force acts after so many ticks in the mean (1/2 and the delay): no
/// more than 0.6 m over that time, since at pi/2 a damping alone swings.
[[nodiscard]] constexpr double most_damping(double mass, double tick, double delay_ticks) noexcept {
  return std::min(most_damping(mass, tick), 0.6 * mass / ((0.5 + delay_ticks) * tick));
}

/// The reaction from which on a braking force acts whole: N, and in encoder steps of the spring,
/// since the first of them would be felt as a knock.
inline constexpr double whole_braking_from = 0.2, whole_braking_steps = 6;

/// The share of a braking force (its size, N) that within_reaction adds to a reaction (N): 0 to 1.
[[nodiscard]] double braking_share(double braking, double reaction,
                                   double whole_from = whole_braking_from) noexcept;

/// What of a braking force (N) is added to a reaction (N): it fades in with the reaction, whole
/// from `whole_from` (N) on, and is never larger than it, so that touching and leaving make no
/// step and nothing holds a hand that leaves. Zero for what is not finite.
[[nodiscard]] Vector3 within_reaction(const Vector3& braking, double reaction,
                                      double whole_from = whole_braking_from) noexcept;

/// The same of what of it lies along the reaction: that is where the spring is which leaks, and a
/// hand that slides is not held.
[[nodiscard]] Vector3 along_reaction(const Vector3& braking, const Vector3& reaction,
                                     double whole_from = whole_braking_from) noexcept;

}  // namespace spm
