// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "servo/devices/base/device_ids.hpp"

namespace spm::servo {

/// Whether this user may open a node to read and write.
enum class NodeAccess : std::uint8_t {
  granted,
  denied,
  missing,  ///< the kernel knows the device, but its node is not there, as in some containers
};

/// A device that is plugged in, as far as can be told without opening it.
struct FoundDevice {
  DeviceMatch match;
  NodeKind kind = NodeKind::usb;
  DeviceIds ids;
  std::string product;  ///< as the device names itself; UTF-8, often empty
  std::string serial;   ///< the same
  std::string usb;      ///< where it is plugged in, bus and ports ("1-2.3"); empty off USB
  std::string node;     ///< what is opened ("/dev/hidraw3")
  NodeAccess access = NodeAccess::denied;

  [[nodiscard]] bool permitted() const noexcept { return access == NodeAccess::granted; }
};

/// What is plugged in.
struct DeviceSearch {
  std::vector<FoundDevice> devices;
  std::vector<std::string> notes;  ///< what could not be looked at, and why; a sentence each
  std::size_t usb_devices = 0;     ///< of any kind, hubs included
};

/// Lists the haptic devices that are plugged in and opens none of them. `root` is where /sys and
/// /dev lie, for what is read from files. No USB at all gives an empty list and a note.
[[nodiscard]] DeviceSearch find_devices(const std::string& root = "");

/// The parts of find_devices: USB devices by libusb's list, HID interfaces by hidapi's, serial
/// lines by their names.
void find_usb_devices(const std::string& root, DeviceSearch& search);
void find_hid_devices(const std::string& root, DeviceSearch& search);
void find_serial_devices(const std::string& root, DeviceSearch& search);

/// Whether this process's user may open a node to read and write.
[[nodiscard]] NodeAccess access_to(const std::string& node) noexcept;

/// The udev line that lets the user open the device; empty where it may be opened already.
[[nodiscard]] std::string udev_rule(const FoundDevice& device);

/// What to do so that the device can be opened, sentences; empty where it may be opened already.
[[nodiscard]] std::string cure_of(const FoundDevice& device);

/// What --device takes to mean this very one: its driver, with its place or serial number where
/// the driver can be told one ("falcon:path=1-2.3").
[[nodiscard]] std::string specification_of(const FoundDevice& device);

/// One object a device, with the keys of `devices --json`.
[[nodiscard]] nlohmann::ordered_json to_json(const FoundDevice& device);

}  // namespace spm::servo
