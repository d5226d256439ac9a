// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/base/vector.hpp"

namespace spm::servo {

/// Where the hand wants the tool to be.
struct HandTarget {
  Vector3 position = Vector3::Zero();  ///< m
  Vector3 velocity = Vector3::Zero();  ///< m/s
};

/// How a hand holds the tool.
enum class HandModel : std::uint8_t {
  spring,  ///< a spring and a damper (the grip) straight to the target
  arm,   ///< the grip holds the mass of an arm, which a second spring and damper pull to the target
  none,  ///< the hand lets go
};

/// The grip, between the tool and the target or the arm. Assumed from one published trial of a
/// finger grip.
inline constexpr double grip_stiffness = 700;  // N/m
inline constexpr double grip_damping = 2.5;    // N s/m

/// The arm behind the grip, and the spring and damper that pull it. Assumed from one published
/// trial.
inline constexpr double arm_mass = 0.554;     // kg
inline constexpr double arm_damping = 6.45;   // N s/m
inline constexpr double arm_stiffness = 135;  // N/m

}  // namespace spm::servo
