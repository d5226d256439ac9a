// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace spm::servo {

/// What a SpaceMouse has reported so far. A report changes a part of it; silence changes nothing.
struct SpaceMouseState {
  std::array<double, 3> push{};       ///< deflection, -1 to 1 for each axis; world frame
  std::array<double, 3> twist{};      ///< the same for the rotation about each axis, right-handed
  std::uint32_t buttons = 0;          ///< in the device's order
  std::int32_t battery_percent = -1;  ///< -1 if it reported none
  bool charging = false;
};

/// Takes a report, its id first, as hidraw returns it: 1 (push, or push and twist), 2 (twist), 3
/// (buttons), 0x17 (battery). False, without a change, for another id or a length that does not fit
/// the id. The axes are converted from the device's (x to the right, y towards the user, z down) to
/// the world's. Counts beyond full deflection, which some devices send [U], are limited to it.
[[nodiscard]] bool take_spacemouse_report(std::span<const std::uint8_t> bytes,
                                          SpaceMouseState& state) noexcept;

/// Counts at full deflection, according to the devices' report descriptors.
inline constexpr int spacemouse_full_deflection = 350;

/// Largest size of one of these reports, bytes.
inline constexpr std::size_t longest_spacemouse_report = 64;

}  // namespace spm::servo
