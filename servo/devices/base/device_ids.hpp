// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace spm::servo {

/// Vendor and product, as USB and Bluetooth report them.
struct DeviceIds {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;

  [[nodiscard]] bool operator==(const DeviceIds&) const = default;
};

/// A Novint Falcon's FTDI chip.
inline constexpr DeviceIds falcon_ids{0x0403, 0xCB48};

/// WoodenHaptics boards of V1 and V2: the default ids of the mbed library, which nobody registered.
inline constexpr DeviceIds wooden_mbed_ids{0x1234, 0x0006};
/// Boards of V3: the ids of any Teensy with raw HID.
inline constexpr DeviceIds wooden_teensy_ids{0x16C0, 0x0486};

/// What is known of a HID interface without opening it.
struct HidIdentity {
  DeviceIds ids;
  std::uint16_t usage_page = 0;  ///< of the top-level collection
  std::uint16_t usage = 0;
  bool has_pid_force = false;  ///< its report descriptor has constant force (has_pid_force)
  std::string_view product_name = {};
};

/// A device that is known by its ids.
struct DeviceMatch {
  const char* driver = "";  ///< its name for --device
  bool driven = true;       ///< false: known, but this version cannot drive it
  const char* note = "";    ///< what the user should know of it, a sentence; often empty
  /// other projects' devices have its ids too: it is used only where the user names it
  bool shares_ids = false;
};

/// Which driver a USB device is for. Nothing if it is none of our devices.
[[nodiscard]] std::optional<DeviceMatch> match_usb(DeviceIds ids) noexcept;

/// Which driver a HID interface is for. Nothing if it is none of our devices.
[[nodiscard]] std::optional<DeviceMatch> match_hid(const HidIdentity& hid) noexcept;

/// Which driver a serial line is for, by its name in /dev/serial/by-id.
[[nodiscard]] std::optional<DeviceMatch> match_serial(std::string_view name) noexcept;

/// Ids of the boards whose serial lines match_serial knows.
inline constexpr DeviceIds serial_board{0x16C0, 0x0483};

/// The part of a name in /dev/serial/by-id that is the board's serial number; empty if there is
/// none.
[[nodiscard]] std::string serial_number_of(std::string_view name);

/// Whether a HID report descriptor names a usage of a page (Device Class Definition for HID 1.11,
/// section 6.2.2). A truncated descriptor is read as far as it goes.
[[nodiscard]] bool has_usage(std::span<const std::uint8_t> descriptor, std::uint16_t page,
                             std::uint16_t usage) noexcept;

/// Usage page of the class of force feedback devices (USB PID 1.0).
inline constexpr std::uint16_t pid_usage_page = 0x0F;
/// What every device that gives constant force has there: Set Constant Force. Pads that only rumble
/// use the page too.
inline constexpr std::uint16_t pid_constant_force_usage = 0x73;
[[nodiscard]] inline bool has_pid_force(std::span<const std::uint8_t> descriptor) noexcept {
  return has_usage(descriptor, pid_usage_page, pid_constant_force_usage);
}

/// The name of the USB device to which a resolved path in /sys belongs ("1-2.3"); empty if there is
/// none.
[[nodiscard]] std::string usb_name_of(std::string_view sysfs_path);

/// By what kind of node a device is opened.
enum class NodeKind : std::uint8_t { usb, hidraw, serial };

[[nodiscard]] const char* to_string(NodeKind kind) noexcept;

/// The udev rule that lets the user who sits at the machine open the device. `on_usb` is false for
/// a HID device on another bus, such as Bluetooth.
[[nodiscard]] std::string udev_rule(NodeKind kind, DeviceIds ids, bool on_usb = true);

}  // namespace spm::servo
