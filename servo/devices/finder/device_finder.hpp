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
  missing,  ///< the kernel knows the device, but its node does not exist, as in some containers
};

/// A device that is plugged in, as far as it is known without opening it.
struct FoundDevice {
  DeviceMatch match;
  NodeKind kind = NodeKind::usb;
  DeviceIds ids;
  std::string product;  ///< the device's own name; UTF-8, often empty
  std::string serial;   ///< the same
  std::string usb;   ///< where it is plugged in, bus and ports ("1-2.3"); empty if it is not on USB
  std::string node;  ///< the node to open ("/dev/hidraw3")
  NodeAccess access = NodeAccess::denied;

  [[nodiscard]] bool permitted() const noexcept { return access == NodeAccess::granted; }
};

/// What is plugged in.
struct DeviceSearch {
  std::vector<FoundDevice> devices;
  std::vector<std::string> notes;  ///< what could not be listed, and why; one sentence each
  std::size_t usb_devices = 0;     ///< number of USB devices of any kind, including hubs
};

/// Lists the haptic devices that are plugged in, without opening any. `root` is the folder that
/// contains /sys and /dev, for what is read from files. Without USB the list is empty, and there is
/// a note.
[[nodiscard]] DeviceSearch find_devices(const std::string& root = "");

/// The parts of find_devices: USB devices from libusb, HID interfaces from hidapi, serial lines by
/// their names.
void find_usb_devices(const std::string& root, DeviceSearch& search);
void find_hid_devices(const std::string& root, DeviceSearch& search);
void find_serial_devices(const std::string& root, DeviceSearch& search);

/// Whether this process's user may open a node to read and write.
[[nodiscard]] NodeAccess access_to(const std::string& node) noexcept;

/// The udev rule that lets the user open the device; empty if it may be opened already.
[[nodiscard]] std::string udev_rule(const FoundDevice& device);

/// What to do so that the device can be opened, sentences; empty if it may be opened already.
[[nodiscard]] std::string cure_of(const FoundDevice& device);

/// The text for --device that means exactly this device: its driver, with its place or serial
/// number if the driver has such an option ("falcon:path=1-2.3").
[[nodiscard]] std::string specification_of(const FoundDevice& device);

/// One object for a device, with the keys of `devices --json`.
[[nodiscard]] nlohmann::ordered_json to_json(const FoundDevice& device);

}  // namespace spm::servo
