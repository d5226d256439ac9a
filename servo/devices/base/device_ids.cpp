// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/base/device_ids.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace spm::servo {

namespace {

/// Other boards have the ids of a WoodenHaptics too, so usage and name must match as well.
constexpr std::string_view wooden_mbed_name = "HID DEVICE";
constexpr std::uint16_t wooden_usage_page = 0xFFAB;
constexpr std::uint16_t wooden_usage = 0x0200;

constexpr std::uint16_t logitech = 0x046D;
constexpr std::uint16_t connexion = 0x256F;

/// 3Dconnexion devices under their first vendor's id, which mice and keyboards share.
constexpr std::array<std::uint16_t, 11> logitech_products{
    0xC603, 0xC605, 0xC606, 0xC621, 0xC623, 0xC625, 0xC626, 0xC627, 0xC628, 0xC629, 0xC62B};

/// Mice and keyboards of 3Dconnexion, which must not be opened. 0xC641 is unverified: no source
/// says for certain what it is.
constexpr std::array<std::uint16_t, 11> connexion_others{
    0xC62C, 0xC641, 0xC650, 0xC651, 0xC654, 0xC655, 0xC656, 0xC657, 0xC658, 0xC664, 0xC668};

constexpr std::uint16_t desktop_page = 0x01;
constexpr std::uint16_t multi_axis = 0x08;

constexpr std::string_view teensy_name = "Teensyduino_USB_Serial";

template <class List>
bool contains(const List& list, std::uint16_t value) noexcept {
  return std::find(list.begin(), list.end(), value) != list.end();
}

bool is_spacemouse(const HidIdentity& hid) noexcept {
  // A receiver has several interfaces; only the multi-axis one moves a tool.
  if (hid.usage_page != desktop_page || hid.usage != multi_axis) return false;
  if (hid.ids.vendor == logitech) return contains(logitech_products, hid.ids.product);
  return hid.ids.vendor == connexion && !contains(connexion_others, hid.ids.product);
}

bool is_woodenhaptics(const HidIdentity& hid) noexcept {
  if (hid.usage_page != wooden_usage_page || hid.usage != wooden_usage) return false;
  return hid.ids == wooden_teensy_ids ||
         (hid.ids == wooden_mbed_ids && hid.product_name == wooden_mbed_name);
}

bool is_digits(std::string_view text) noexcept {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

std::optional<DeviceMatch> match_usb(DeviceIds ids) noexcept {
  if (ids == falcon_ids) return DeviceMatch{"falcon", true, ""};
  return std::nullopt;
}

std::optional<DeviceMatch> match_hid(const HidIdentity& hid) noexcept {
  if (is_woodenhaptics(hid)) {
    if (hid.ids != wooden_teensy_ids) return DeviceMatch{"woodenhaptics", true, ""};
    return DeviceMatch{
        "woodenhaptics", true,
        "A Teensy with raw HID, as WoodenHaptics V3 has; other projects' boards have "
        "the same ids, so that auto never takes it.",
        true};
  }
  if (is_spacemouse(hid)) {
    return DeviceMatch{"spacemouse", true, "It moves a tool or the scene and gives no force."};
  }
  if (hid.has_pid_force) {
    return DeviceMatch{"pid", true,
                       "A force feedback device of the HID PID class; say how strong it is, as in "
                       "--device pid:full_force=8N, which auto cannot know."};
  }
  return std::nullopt;
}

std::optional<DeviceMatch> match_serial(std::string_view name) noexcept {
  if (name.find(teensy_name) == std::string_view::npos) return std::nullopt;
  return DeviceMatch{"woodenhaptics", false,
                     "A Teensy board with a serial line, as WoodenHaptics V4 and V5 have (other "
                     "projects' boards have the same name); this version does not drive the "
                     "serial line yet."};
}

std::string serial_number_of(std::string_view name) {
  // usb-Maker_Product_SERIAL-ifNN
  const std::string_view body = name.substr(0, name.rfind("-if"));
  const std::size_t underscore = body.rfind('_');
  if (underscore == std::string_view::npos) return {};
  const std::string_view serial = body.substr(underscore + 1);
  return is_digits(serial) ? std::string(serial) : std::string();
}

bool has_usage(std::span<const std::uint8_t> descriptor, std::uint16_t page,
               std::uint16_t usage) noexcept {
  constexpr std::uint8_t long_item = 0xFE;
  constexpr std::uint8_t usage_page_item = 0x04;  // global, tag 0
  constexpr std::uint8_t usage_item = 0x08;       // local, tag 0
  std::uint32_t page_now = 0;
  std::size_t at = 0;
  while (at < descriptor.size()) {
    const std::uint8_t prefix = descriptor[at];
    if (prefix == long_item) {
      if (at + 1 >= descriptor.size()) return false;
      at += 3 + std::size_t{descriptor[at + 1]};
      continue;
    }
    const std::size_t code = prefix & 0x03U;
    const std::size_t bytes = code == 3 ? 4 : code;
    if (at + bytes >= descriptor.size()) return false;
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i) {
      value |= std::uint32_t{descriptor[at + 1 + i]} << (8 * i);
    }
    const std::uint8_t item = prefix & 0xFCU;
    if (item == usage_page_item) page_now = value;
    // One of four bytes has its page with it.
    if (item == usage_item && bytes < 4) value |= page_now << 16U;
    if (item == usage_item && value == (std::uint32_t{page} << 16U | usage)) return true;
    at += 1 + bytes;
  }
  return false;
}

std::string usb_name_of(std::string_view sysfs_path) {
  // The path component of an interface is the device's name, a colon, configuration and interface.
  std::string name;
  while (!sysfs_path.empty()) {
    const std::size_t slash = sysfs_path.find('/');
    const std::string_view part = sysfs_path.substr(0, slash);
    const std::size_t colon = part.find(':');
    const std::string_view head = part.substr(0, colon);
    const std::size_t dash = head.find('-');
    const bool interface = colon != std::string_view::npos && dash != std::string_view::npos;
    if (interface && is_digits(head.substr(0, dash))) name = head;
    sysfs_path =
        slash == std::string_view::npos ? std::string_view() : sysfs_path.substr(slash + 1);
  }
  return name;
}

const char* to_string(NodeKind kind) noexcept {
  switch (kind) {
    case NodeKind::usb:
      return "usb";
    case NodeKind::hidraw:
      return "hidraw";
    case NodeKind::serial:
      return "serial";
  }
  return "unknown";
}

std::string udev_rule(NodeKind kind, DeviceIds ids, bool on_usb) {
  const std::string grant = "TAG+=\"uaccess\"";
  if (kind == NodeKind::usb) {
    return fmt::format(
        "SUBSYSTEM==\"usb\", ENV{{DEVTYPE}}==\"usb_device\", ATTR{{idVendor}}==\"{:04x}\", "
        "ATTR{{idProduct}}==\"{:04x}\", {}",
        ids.vendor, ids.product, grant);
  }
  const char* subsystem = kind == NodeKind::hidraw ? "hidraw" : "tty";
  if (!on_usb) {
    // The name of the HID device above: bus, vendor, product, number.
    return fmt::format("SUBSYSTEM==\"{}\", KERNELS==\"*:{:04X}:{:04X}.*\", {}", subsystem,
                       ids.vendor, ids.product, grant);
  }
  return fmt::format(
      "SUBSYSTEM==\"{}\", ATTRS{{idVendor}}==\"{:04x}\", ATTRS{{idProduct}}==\"{:04x}\", {}",
      subsystem, ids.vendor, ids.product, grant);
}

}  // namespace spm::servo
