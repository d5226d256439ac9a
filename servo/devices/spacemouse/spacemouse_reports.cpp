// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/spacemouse/spacemouse_reports.hpp"

#include <algorithm>
#include <cstddef>

namespace spm::servo {

namespace {

constexpr std::uint8_t push_id = 1, twist_id = 2, buttons_id = 3, battery_id = 0x17;

/// Three numbers of 16 bits, converted to the world's frame; full deflection is 1.
std::array<double, 3> axes(std::span<const std::uint8_t> bytes) noexcept {
  std::array<double, 3> device{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto bits = static_cast<std::uint16_t>(bytes[2 * i] | (bytes[2 * i + 1] << 8));
    const int count = std::clamp<int>(static_cast<std::int16_t>(bits), -spacemouse_full_deflection,
                                      spacemouse_full_deflection);
    device[i] = static_cast<double>(count) / spacemouse_full_deflection;
  }
  return {device[0], -device[2], device[1]};
}

}  // namespace

bool take_spacemouse_report(std::span<const std::uint8_t> bytes, SpaceMouseState& state) noexcept {
  if (bytes.empty()) return false;
  const auto payload = bytes.subspan(1);
  switch (bytes[0]) {
    case push_id:
      // The length distinguishes the layouts, not the product.
      if (payload.size() != 6 && payload.size() != 12) return false;
      state.push = axes(payload);
      if (payload.size() == 12) state.twist = axes(payload.subspan(6));
      return true;
    case twist_id:
      if (payload.size() != 6) return false;
      state.twist = axes(payload);
      return true;
    case buttons_id: {
      if (payload.size() < 2 || payload.size() > 6) return false;
      state.buttons = 0;
      for (std::size_t i = 0; i < std::min<std::size_t>(payload.size(), 4); ++i) {
        state.buttons |= static_cast<std::uint32_t>(payload[i]) << (8 * i);
      }
      return true;
    }
    case battery_id:
      if (payload.size() != 2) return false;
      state.battery_percent = payload[0];
      state.charging = (payload[1] & 1U) != 0;
      return true;
    default:
      return false;
  }
}

}  // namespace spm::servo
