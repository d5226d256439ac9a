// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

#include "common/base/device_profile.hpp"

namespace spm {

/// How stiff a flat wall may be before a device shakes on it, N/m at its tool.
struct StiffnessBorder {
  std::string_view device;  ///< a profile's name
  double hold;              ///< pressed and held
  double tap;               ///< met at 0.5 m/s
};

/// At 1 kHz with one tick of delay and no cure, in simulation: of the masses, damping and friction
/// that sim_profile.hpp assumes, in a hand of two masses; no device was measured. By the stability
/// laboratory's flat wall with the exact penalty, and its tap with the bare proxy. In the order of
/// `device_profiles`.
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

/// Of the lower border, what is taken: shapes that are worse than a flat wall are allowed for.
inline constexpr double stiffness_margin = 0.6;

/// The stiffness that `"auto"` stands for, N/m at the device's tool: so much of the border, and no
/// more than the device is rated for. `device` must be one of `device_profiles`.
[[nodiscard]] constexpr double stable_stiffness(const DeviceProfile& device) noexcept {
  for (const StiffnessBorder& border : stiffness_borders) {
    if (border.device != device.name) continue;
    return std::min(stiffness_margin * std::min(border.hold, border.tap), device.stiffness_cap);
  }
  return 0;
}

}  // namespace spm
