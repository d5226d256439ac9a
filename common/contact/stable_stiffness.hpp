// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "common/base/device_profile.hpp"
#include "common/contact/stiffness_borders.hpp"

namespace spm {

static_assert([] {
  for (std::size_t i = 0; i < device_profiles.size(); ++i) {
    if (stiffness_borders[i].device != device_profiles[i].name) return false;
  }
  return true;
}());

/// Part of the lower border of a flat wall that is used; the rest allows for other shapes and for
/// devices that are worse than their profile.
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
static_assert([] {
  for (std::size_t i = 0; i < device_profiles.size(); ++i) {
    if (stable_stiffness(device_profiles[i]) > stiffness_borders[i].served) return false;
  }
  return true;
}());

}  // namespace spm
