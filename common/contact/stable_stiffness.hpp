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

/// stiffness_margin of the border, N/m at the device's tool, whatever the device is rated for.
/// `device` must be one of `device_profiles`.
[[nodiscard]] constexpr double margin_below_border(const DeviceProfile& device) noexcept {
  for (const StiffnessBorder& border : stiffness_borders) {
    if (border.device != device.name) continue;
    return stiffness_margin * std::min(border.hold, border.tap);
  }
  return 0;
}

/// The border with the default settings in the laboratory's other cases, N/m at the device's tool.
/// `device` must be one of `device_profiles`.
[[nodiscard]] constexpr double served_border(const DeviceProfile& device) noexcept {
  for (const StiffnessBorder& border : stiffness_borders) {
    if (border.device == device.name) return border.served;
  }
  return 0;
}

/// The stiffness that `"auto"` stands for, N/m at the device's tool: stiffness_margin of the
/// border, and at most the device's rated stiffness. `device` must be one of `device_profiles`.
[[nodiscard]] constexpr double stable_stiffness(const DeviceProfile& device) noexcept {
  return std::min(margin_below_border(device), device.stiffness_cap);
}

/// The tick and the delay in it at which the borders were measured, s and ticks.
inline constexpr double border_tick = 1e-3, border_delay_ticks = 1;

/// The share of a device's stable stiffness that is left in a loop of another delay or tick, up to
/// 1: the border of a wall goes with the reciprocal of half a tick and all delays together (Gil et
/// al. 2004; Hulin et al. 2006). `lag` and `tick` in s, `delay_ticks` 0 or more.
[[nodiscard]] constexpr double stiffness_share(double lag, double delay_ticks,
                                               double tick) noexcept {
  const double measured = (0.5 + border_delay_ticks) * border_tick + lag;
  return std::min(1.0, measured / ((0.5 + delay_ticks) * tick + lag));
}

static_assert([] {
  for (std::size_t i = 0; i < device_profiles.size(); ++i) {
    if (stable_stiffness(device_profiles[i]) > stiffness_borders[i].served) return false;
  }
  return true;
}());

}  // namespace spm
