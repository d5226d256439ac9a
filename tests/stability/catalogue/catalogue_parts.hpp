// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "tests/stability/objects/stability_case.hpp"

namespace spm::stability {

// How the cases' hands are led. A hand is soft: its target lies centimetres below what it presses,
// and it takes a way to get up to speed. All figures were set by the plant alone, on a wall.

/// N, that a hand presses with where nothing else is said: below every device's cap, above what
/// half a millimetre of 3 N/mm holds.
inline constexpr double default_press = 2;
/// m/s, where nothing else is said.
inline constexpr double default_speed = 0.05;
/// s, that a hand rests at the end. A tap at 1 m/s rings for about 1 s on a wall; what is judged
/// are the last 0.7 s.
inline constexpr double default_rest = 2;
/// m, of the ball.
inline constexpr double ball_radius = 2e-3;

/// How far below what holds its tool a hand's target lies when it presses with a force (N), m: arm
/// and grip in series.
[[nodiscard]] double press_depth(double force) noexcept;

/// How far above the surface a hand starts, m, so that the tool of `low` meets it with about the
/// target's speed (m/s): never less than 2 mm.
[[nodiscard]] double runway(double speed) noexcept;

/// What is pressed, and how.
struct Press {
  Vector3 place = Vector3::Zero();    ///< m, of the probe's centre where it just touches
  Vector3 normal = Vector3::UnitZ();  ///< unit, outward: the hand comes against it
  double speed = default_speed;       ///< m/s
  double force = default_press;       ///< N
  double rest = default_rest;         ///< s
};

/// A case of pressing straight down and staying. A band of 5 mm holds that of a device at 0.4 N/mm.
[[nodiscard]] StabilityCase press_case(std::string theme, std::string name, std::string title,
                                       test::Shape shape, const Press& press);

/// Where the hand's target is while it presses, m.
[[nodiscard]] Vector3 pressed_target(const Press& press) noexcept;

/// How long the hand's legs take, s.
[[nodiscard]] double script_seconds(const StabilityCase& tried) noexcept;

}  // namespace spm::stability
