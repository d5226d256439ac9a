// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/vector.hpp"

namespace spm {

/// The damping, N s/m, that takes from a hand what a sampled spring of stiffness K (N/m) gives it:
/// share K (1/2 + d) T. The zero-order hold leaks K T / 2 (Colgate and Schenkel 1997: b > K T / 2),
/// a delay of d ticks of length T (s) another d K T; a share of 1 is all of it, and 0.8 is advised.
[[nodiscard]] constexpr double matched_damping(double share, double stiffness, double delay_ticks,
                                               double tick) noexcept {
  return share * stiffness * (0.5 + delay_ticks) * tick;
}

/// The most that may be damped, N s/m, of a device of so much moving mass (kg): 0.25 m / T. More
/// answers a velocity of the tick before with a force that turns it round.
[[nodiscard]] constexpr double most_damping(double mass, double tick) noexcept {
  return 0.25 * mass / tick;
}

/// The reaction from which on a braking force acts whole, N.
inline constexpr double whole_braking_from = 0.2;

/// What of a braking force (N) is added to a reaction (N): it fades in with the reaction, whole
/// from whole_braking_from on, and is never larger than it, so that touching and leaving make no
/// step and nothing holds a hand that leaves. Zero for what is not finite.
[[nodiscard]] Vector3 within_reaction(const Vector3& braking, double reaction) noexcept;

}  // namespace spm
