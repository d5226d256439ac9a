// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace spm {

/// What is felt changes by a command over this time, s, or slower where the force would change
/// faster than `change_rate`.
inline constexpr double change_seconds = 0.15;

/// The fastest change of a force that a command alone makes, N/s. In a tick of 1 ms that is 0.06 N,
/// less than the 7 % that people notice, of any force from 1 N on.
inline constexpr double change_rate = 60;

/// How much of a change, 0 to 1, is made in `seconds` where all of it would be `newtons` (0 or
/// more) of force.
[[nodiscard]] inline double change_share(double seconds, double newtons) noexcept {
  const double share = seconds / change_seconds;
  const double most = change_rate * seconds;
  return std::min(1.0, newtons * share > most ? most / newtons : share);
}

/// From `now` towards a number, by a share of the way from `from`, and by no more than `most`.
[[nodiscard]] inline double stepped(double now, double from, double to, double share,
                                    double most) noexcept {
  const double step = std::min(share * std::abs(to - from), most);
  return now + std::clamp(to - now, -step, step);
}

/// m: at this arm a torque counts as the force that it is felt as in the fingers.
inline constexpr double finger_arm = 0.01;

}  // namespace spm
