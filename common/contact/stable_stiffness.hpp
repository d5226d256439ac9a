// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

#include "common/base/device_profile.hpp"

namespace spm {

/// Largest stiffness of a flat wall before a device begins to shake on it, N/m at its tool.
struct StiffnessBorder {
  std::string_view device;  ///< a profile's name
  double hold;              ///< while pressed and held
  double tap;               ///< when hit at 0.5 m/s
};

/// Borders at 1 kHz with one tick of delay and without stabilization, from simulation: with the
/// masses, damping and friction that sim_profile.hpp assumes, in a hand of two masses. No device
/// was measured. Measured on the stability laboratory's flat wall with the exact penalty, and on
/// its tap with the bare proxy. In the order of `device_profiles`.
inline constexpr std::array<StiffnessBorder, device_profiles.size()> stiffness_borders{{
    {"low", 1985, 1701},
    {"falcon", 6464, 4669},
    {"touch", 3622, 3812},
    {"omega3", 4948, 3453},
    {"wooden", 8446, 6312},
}};
static_assert([] {
  for (std::size_t i = 0; i < device_profiles.size(); ++i) {
    if (stiffness_borders[i].device != device_profiles[i].name) return false;
  }
  return true;
}());

/// Part of the lower border that is used; the rest allows for shapes that are worse than a flat
/// wall.
inline constexpr double stiffness_margin = 0.6;

/// The stiffness that `"auto"` stands for, N/m at the device's tool: stiffness_margin of the
/// border, and at most the device's rated stiffness. `device` must be one of `device_profiles`.
[[nodiscard]] constexpr double stable_stiffness(const DeviceProfile& device) noexcept {
  for (const StiffnessBorder& border : stiffness_borders) {
    if (border.device != device.name) continue;
    return std::min(stiffness_margin * std::min(border.hold, border.tap), device.stiffness_cap);
  }
  return 0;
}

}  // namespace spm
