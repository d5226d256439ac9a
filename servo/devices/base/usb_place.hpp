// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>
#include <libusb-1.0/libusb.h>

#include <array>
#include <cstdint>
#include <string>

namespace spm::servo {

/// Bus and ports of a USB device, as the kernel names it in /sys/bus/usb/devices ("1-2.3"). The
/// name stays the same as long as the plug is not moved. Empty for a root hub.
[[nodiscard]] inline std::string usb_place(libusb_device* device) {
  // The deepest chain of hubs that USB allows, and the device behind it.
  std::array<std::uint8_t, 7> ports{};
  const int count = libusb_get_port_numbers(device, ports.data(), static_cast<int>(ports.size()));
  if (count <= 0) return {};
  std::string name = fmt::format("{}-{}", libusb_get_bus_number(device), ports[0]);
  for (std::size_t i = 1; i < static_cast<std::size_t>(count); ++i) {
    name += fmt::format(".{}", ports[i]);
  }
  return name;
}

}  // namespace spm::servo
