// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/finder/device_finder.hpp"

#include <fmt/format.h>
#include <libusb-1.0/libusb.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>

#include "servo/devices/base/usb_place.hpp"
#include "servo/devices/hid/hid_bus.hpp"

namespace spm::servo {

namespace {

namespace fs = std::filesystem;

constexpr const char* rules_file = "/etc/udev/rules.d/70-spm-haptics.rules";

std::string first_line(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

std::vector<std::uint8_t> bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void add_usb_device(const std::string& root, libusb_device* device, DeviceSearch& search) {
  libusb_device_descriptor descriptor{};
  if (libusb_get_device_descriptor(device, &descriptor) != LIBUSB_SUCCESS) return;
  const DeviceIds ids{descriptor.idVendor, descriptor.idProduct};
  const auto match = match_usb(ids);
  if (!match) return;
  FoundDevice found;
  found.match = *match;
  found.kind = NodeKind::usb;
  found.ids = ids;
  found.usb = usb_place(device);
  // The kernel read the strings when the device was plugged in.
  if (!found.usb.empty()) {
    const std::string folder = root + "/sys/bus/usb/devices/" + found.usb;
    found.product = first_line(folder + "/product");
    found.serial = first_line(folder + "/serial");
  }
  found.node = fmt::format("/dev/bus/usb/{:03}/{:03}", libusb_get_bus_number(device),
                           libusb_get_device_address(device));
  found.access = access_to(root + found.node);
  search.devices.push_back(std::move(found));
}

void add_hid_device(const std::string& root, const HidDevice& hid, DeviceSearch& search) {
  // A node has one entry for each of its top-level collections.
  const auto same_node = [&](const FoundDevice& known) { return known.node == hid.path; };
  if (std::any_of(search.devices.begin(), search.devices.end(), same_node)) return;

  const fs::path parent =
      root + "/sys/class/hidraw/" + fs::path(hid.path).filename().string() + "/device";
  const bool pid = has_pid_force(bytes_of(parent / "report_descriptor"));
  const DeviceIds ids{hid.vendor, hid.product};
  const auto match = match_hid({ids, hid.usage_page, hid.usage, pid, hid.product_name});
  if (!match) return;

  FoundDevice found;
  found.match = *match;
  found.kind = NodeKind::hidraw;
  found.ids = ids;
  found.product = hid.product_name;
  found.serial = hid.serial;
  std::error_code ignored;
  found.usb = usb_name_of(fs::canonical(parent, ignored).string());
  found.node = hid.path;
  found.access = access_to(root + hid.path);
  search.devices.push_back(std::move(found));
}

}  // namespace

NodeAccess access_to(const std::string& node) noexcept {
  if (access(node.c_str(), R_OK | W_OK) == 0) return NodeAccess::granted;
  return errno == ENOENT || errno == ENOTDIR ? NodeAccess::missing : NodeAccess::denied;
}

void find_usb_devices(const std::string& root, DeviceSearch& search) {
  libusb_context* context = nullptr;
  if (const int failed = libusb_init(&context); failed != LIBUSB_SUCCESS) {
    search.notes.push_back(fmt::format(
        "USB cannot be looked at ({}): this machine has none, or this user may not see it.",
        libusb_strerror(failed)));
    return;
  }
  libusb_device** list = nullptr;
  const auto count = libusb_get_device_list(context, &list);
  if (count >= 0) {
    search.usb_devices = static_cast<std::size_t>(count);
    const std::span devices(list, search.usb_devices);
    for (libusb_device* device : devices) add_usb_device(root, device, search);
    libusb_free_device_list(list, 1);
  } else {
    search.notes.push_back(
        fmt::format("USB devices cannot be listed ({}); plug one in and try "
                    "again.",
                    libusb_strerror(static_cast<int>(count))));
  }
  libusb_exit(context);
}

void find_hid_devices(const std::string& root, DeviceSearch& search) {
  const auto devices = list_hid_devices();
  if (!devices) {
    search.notes.push_back(devices.error().message + ".");
    return;
  }
  for (const HidDevice& hid : *devices) add_hid_device(root, hid, search);
}

void find_serial_devices(const std::string& root, DeviceSearch& search) {
  const std::string folder = "/dev/serial/by-id";
  std::error_code failed;
  for (fs::directory_iterator entry(root + folder, failed), end; !failed && entry != end;
       entry.increment(failed)) {
    const std::string name = entry->path().filename().string();
    const auto match = match_serial(name);
    if (!match) continue;
    FoundDevice found;
    found.match = *match;
    found.kind = NodeKind::serial;
    found.ids = serial_board;
    found.product = "Teensyduino USB Serial";
    found.serial = serial_number_of(name);
    found.node = fmt::format("{}/{}", folder, name);
    found.access = access_to(root + found.node);
    search.devices.push_back(std::move(found));
  }
}

DeviceSearch find_devices(const std::string& root) {
  DeviceSearch search;
  find_usb_devices(root, search);
  find_hid_devices(root, search);
  find_serial_devices(root, search);
  // The libraries list devices in the order of the kernel. Sorting gives the same list each time on
  // the same machine.
  std::sort(search.devices.begin(), search.devices.end(),
            [](const FoundDevice& a, const FoundDevice& b) { return a.node < b.node; });
  return search;
}

std::string udev_rule(const FoundDevice& device) {
  if (device.permitted()) return {};
  const bool on_usb = device.kind != NodeKind::hidraw || !device.usb.empty();
  return udev_rule(device.kind, device.ids, on_usb);
}

std::string cure_of(const FoundDevice& device) {
  switch (device.access) {
    case NodeAccess::granted:
      return {};
    case NodeAccess::missing:
      return fmt::format(
          "The node {} is not there: in a container, hand it in (--device {}); else unplug the "
          "device and plug it in again.",
          device.node, device.node);
    case NodeAccess::denied:
      return fmt::format(
          "Run: echo '{}' | sudo tee -a {} && sudo udevadm control --reload && sudo udevadm "
          "trigger (this lets in whoever sits at this machine; over ssh, put GROUP=\"plugdev\", "
          "MODE=\"0660\" at the line's end and be in that group).",
          udev_rule(device), rules_file);
  }
  return {};
}

std::string specification_of(const FoundDevice& device) {
  std::string driver = device.match.driver;
  if (driver == "falcon" && !device.usb.empty()) return driver + ":path=" + device.usb;
  const bool by_serial = driver == "woodenhaptics" || driver == "spacemouse" || driver == "pid";
  // Options are separated by commas, so a serial number with a comma cannot be used.
  if (by_serial && !device.serial.empty() && device.serial.find(',') == std::string::npos) {
    return driver + ":serial=" + device.serial;
  }
  // Named all the same, as the driver wants it.
  if (driver == "woodenhaptics" && device.match.shares_ids) return driver + ":protocol=v3";
  return driver;
}

nlohmann::ordered_json to_json(const FoundDevice& device) {
  const std::string cure = cure_of(device);
  const std::string rule = device.access == NodeAccess::denied ? udev_rule(device) : "";
  const auto or_null = [](const std::string& text) {
    return text.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(text);
  };
  return {{"driver", device.match.driver},
          {"driven", device.match.driven},
          {"device", or_null(device.match.driven ? specification_of(device) : "")},
          {"product", device.product},
          {"serial", device.serial},
          {"ids", fmt::format("{:04x}:{:04x}", device.ids.vendor, device.ids.product)},
          {"kind", to_string(device.kind)},
          {"usb", or_null(device.usb)},
          {"node", device.node},
          {"permitted", device.permitted()},
          {"cure", or_null(cure)},
          {"udev_rule", or_null(rule)},
          {"note", or_null(device.match.note)}};
}

}  // namespace spm::servo
