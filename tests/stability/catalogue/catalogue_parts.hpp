// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "tests/stability/objects/stability_case.hpp"

namespace spm::stability {

// How the hand is led in the cases. A hand is soft: its target lies centimetres below what it
// presses, and it needs some distance to get up to speed. All figures were set by the plant alone,
// on a wall.

/// Default force, N, that a hand presses with: below every device's cap, and above what half a
/// millimetre at 3 N/mm holds.
inline constexpr double default_press = 2;
/// Default speed, m/s.
inline constexpr double default_speed = 0.05;
/// Default time, s, that a hand rests at the end. A tap at 1 m/s rings for about 1 s on a wall;
/// only the last 0.7 s are judged.
inline constexpr double default_rest = 2;
/// Radius of the ball, m.
inline constexpr double ball_radius = 2e-3;

/// How far, m, a hand's target lies below the surface that holds the tool when the hand presses
/// with a force (N): arm and grip in series.
[[nodiscard]] double press_depth(double force) noexcept;

/// How far above the surface a hand starts, m, so that the tool of `low` meets it with about the
/// target's speed (m/s): never less than 2 mm.
[[nodiscard]] double runway(double speed) noexcept;

/// Where and how a hand presses.
struct Press {
  Vector3 place = Vector3::Zero();    ///< m, of the probe's centre where it just touches
  Vector3 normal = Vector3::UnitZ();  ///< unit, outward: the hand comes against it
  double speed = default_speed;       ///< m/s
  double force = default_press;       ///< N
  double rest = default_rest;         ///< s
};

/// A case in which the hand presses straight down and stays. A band of 5 mm is enough for a device
/// at 0.4 N/mm.
[[nodiscard]] StabilityCase press_case(std::string theme, std::string name, std::string title,
                                       test::Shape shape, const Press& press);

/// Where the hand's target is while it presses, m.
[[nodiscard]] Vector3 pressed_target(const Press& press) noexcept;

/// How long the hand's legs take, s.
[[nodiscard]] double script_seconds(const StabilityCase& tried) noexcept;

}  // namespace spm::stability
