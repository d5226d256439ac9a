// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

#include "common/base/device_profile.hpp"

namespace spm::servo {

/// A device with one moving mass, as it is at its tool. Damping and friction are assumed: no data
/// sheet gives them. The other values are those of device_profile.hpp.
struct SimProfile {
  std::string_view name;
  double mass;          ///< kg
  double damping;       ///< N s/m
  double friction;      ///< N, Coulomb
  double encoder_step;  ///< m
  double force_cap;     ///< N
  double bandwidth;     ///< Hz, of the actuator, a first-order lag
};

/// A profile of device_profile.hpp, completed with what a simulation needs.
[[nodiscard]] constexpr SimProfile sim_profile(const DeviceProfile& device, double damping,
                                               double friction) noexcept {
  return {device.name,         device.moving_mass, damping,         friction,
          device.encoder_step, device.force_cap,   device.bandwidth};
}

/// In the order of `device_profiles`. `low` is the worst case for stability: light, and hardly
/// damped.
inline constexpr std::array<SimProfile, device_profiles.size()> sim_profiles{{
    sim_profile(device_profiles[0], 0.3, 0.02),
    sim_profile(device_profiles[1], 1.5, 0.35),
    sim_profile(device_profiles[2], 0.1, 0.20),
    sim_profile(device_profiles[3], 0.6, 0.20),
    sim_profile(device_profiles[4], 0.8, 0.50),
}};
static_assert(sim_profiles[1].name == "falcon" && sim_profiles[2].name == "touch" &&
              sim_profiles[3].name == "omega3" && sim_profiles[4].name == "wooden");

/// The profile of that name, or null.
[[nodiscard]] constexpr const SimProfile* find_sim_profile(std::string_view name) noexcept {
  for (const SimProfile& profile : sim_profiles) {
    if (profile.name == name) return &profile;
  }
  return nullptr;
}

}  // namespace spm::servo
