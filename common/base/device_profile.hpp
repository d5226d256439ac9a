// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <numbers>
#include <string>
#include <string_view>

namespace spm {

// How a handle turns, the same for every kind, since no data sheet gives it; assumed.
inline constexpr double assumed_gyration = 0.03;      ///< m, its radius about any axis
inline constexpr double assumed_encoder_lever = 0.1;  ///< m, from its middle to what reads its turn
inline constexpr double assumed_torque_lever = 0.05;  ///< m, at which a motor's force turns it

/// The properties of a kind of haptic device that a bake and the servo use, given at its tool.
struct DeviceProfile {
  std::string_view name;
  double encoder_step;              ///< m, smallest step that it resolves at its centre
  double force_cap;                 ///< N, largest force that may ever be sent to it
  double stiffness_cap;             ///< N/m, largest stiffness that it renders stably
  std::array<double, 3> workspace;  ///< m, edges of the box that contains the tool's whole
                                    ///< workspace: x to the right, y up, z towards the user
  double moving_mass;               ///< kg at the tool; assumed, no data sheet gives it
  double bandwidth;  ///< Hz, of the actuator, modelled as a first-order lag; assumed from the kind
                     ///< of actuator

  /// Time constant of the actuator, s: 1 / (2 pi bandwidth).
  [[nodiscard]] constexpr double actuator_lag() const noexcept {
    return 1 / (2 * std::numbers::pi * bandwidth);
  }

  // Of a device of this kind that turns as well; all assumed.
  /// N m, the largest torque.
  [[nodiscard]] constexpr double torque_cap() const noexcept {
    return force_cap * assumed_torque_lever;
  }
  /// rad, the smallest turn that it resolves.
  [[nodiscard]] constexpr double turn_step() const noexcept {
    return encoder_step / assumed_encoder_lever;
  }
  /// kg m2, about any axis.
  [[nodiscard]] constexpr double turning_inertia() const noexcept {
    return moving_mass * assumed_gyration * assumed_gyration;
  }
};

/// Force, stiffness and step are the makers' ratings, as CHAI3D 3.3 ships them. People build
/// `wooden` themselves; its values follow from its motors and its published parameters. Workspaces
/// are outer figures, because a model is cut to them: the makers' figures, and for `wooden` its
/// longest published edge in every direction. `low` is the worst case for stability: it is as
/// strong and as stiff as any other profile, and its workspace contains all others.
inline constexpr std::array<DeviceProfile, 5> device_profiles{{
    {"low", 20e-6, 12, 5000, {0.45, 0.45, 0.45}, 0.10, 500},
    {"falcon", 64e-6, 8, 3000, {0.102, 0.102, 0.102}, 0.25, 200},
    {"touch", 55e-6, 3.3, 400, {0.431, 0.348, 0.165}, 0.045, 200},
    {"omega3", 9e-6, 12, 5000, {0.16, 0.16, 0.11}, 0.25, 500},
    {"wooden", 55e-6, 10, 1000, {0.3, 0.3, 0.3}, 0.30, 200},
}};

/// What is assumed of a device of no known kind: no other profile shakes on softer surfaces.
inline constexpr const DeviceProfile& worst_device_profile = device_profiles.front();
static_assert(worst_device_profile.name == "low");

/// The profile with this name, or null.
[[nodiscard]] constexpr const DeviceProfile* find_device_profile(std::string_view name) noexcept {
  for (const DeviceProfile& profile : device_profiles) {
    if (profile.name == name) return &profile;
  }
  return nullptr;
}

/// The names of all profiles, each with a leading blank; for messages.
[[nodiscard]] inline std::string device_profile_names() {
  std::string names;
  for (const DeviceProfile& profile : device_profiles) names.append(" ").append(profile.name);
  return names;
}

}  // namespace spm
