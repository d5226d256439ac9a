// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

#include "servo/force_caps.hpp"

namespace spm::servo {

/// A device with one moving mass, seen from its tool. Mass, damping and friction are assumed: no
/// data sheet gives them. Encoder step and force cap are the makers' figures, the actuator's
/// bandwidth is a guess by its kind.
struct SimProfile {
  std::string_view name;
  double mass;          ///< kg
  double damping;       ///< N s/m
  double friction;      ///< N, Coulomb
  double encoder_step;  ///< m
  double force_cap;     ///< N
  double bandwidth;     ///< Hz, of the actuator, a first-order lag
};

/// `low` is the worst case for stability: light, and hardly damped.
inline constexpr std::array<SimProfile, 5> sim_profiles{{
    {"low", 0.10, 0.3, 0.02, 20e-6, force_cap_low, 500},
    {"falcon", 0.25, 1.5, 0.35, 64e-6, force_cap_falcon, 200},
    {"touch", 0.045, 0.1, 0.20, 55e-6, force_cap_touch, 200},
    {"omega3", 0.25, 0.6, 0.20, 9e-6, force_cap_omega3, 500},
    {"wooden", 0.30, 0.8, 0.50, 55e-6, force_cap_wooden, 200},
}};

/// The profile of that name, or null.
[[nodiscard]] constexpr const SimProfile* find_sim_profile(std::string_view name) noexcept {
  for (const SimProfile& profile : sim_profiles) {
    if (profile.name == name) return &profile;
  }
  return nullptr;
}

/// How a hand holds the tool: a spring and a damper towards where the hand wants to be. Assumed
/// from one published trial of a finger grip.
inline constexpr double grip_stiffness = 700;  // N/m
inline constexpr double grip_damping = 2.5;    // N s/m

}  // namespace spm::servo
