// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace spm::servo {

/// What a SpaceMouse told so far. A report changes a part of it, and silence nothing.
struct SpaceMouseState {
  std::array<double, 3> push{};       ///< deflection, -1 to 1 an axis; world frame
  std::array<double, 3> twist{};      ///< the same about each axis, right-handed
  std::uint32_t buttons = 0;          ///< in the device's order
  std::int32_t battery_percent = -1;  ///< -1 where it told none
  bool charging = false;
};

/// Takes a report, its id first, as hidraw gives it: 1 (push, or push and twist), 2 (twist), 3
/// (buttons), 0x17 (battery). False, and nothing changed, for another id or a length that the id
/// does not have.
/// The axes are turned from the device's (x to the right, y towards the user, z down) to the
/// world's. Counts beyond full deflection, which some devices give [U], are held to it.
[[nodiscard]] bool take_spacemouse_report(std::span<const std::uint8_t> bytes,
                                          SpaceMouseState& state) noexcept;

/// Counts at full deflection, by the devices' report descriptors.
inline constexpr int spacemouse_full_deflection = 350;

/// Bytes that the longest of these reports may have.
inline constexpr std::size_t longest_spacemouse_report = 64;

}  // namespace spm::servo
