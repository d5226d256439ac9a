// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/finder/device_finder.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <random>
#include <vector>

#include "servo/devices/finder/device_list.hpp"
#include "tests/servo/support/shape_asset.hpp"
#include "tests/support/as_nobody.hpp"
#include "tests/support/skip.hpp"

namespace device_finder_test {

using namespace spm::servo;
using spm::test::AsNobody;
using spm::test::TemporaryFolder;

namespace {

std::string driver_of(const std::optional<DeviceMatch>& match) {
  return match ? match->driver : "none";
}

std::string driver_of_hid(DeviceIds ids, std::uint16_t page, std::uint16_t usage, bool pid = false,
                          std::string_view name = "HID DEVICE") {
  return driver_of(match_hid({ids, page, usage, pid, name}));
}

FoundDevice denied(NodeKind kind, DeviceIds ids) {
  FoundDevice device;
  device.kind = kind;
  device.ids = ids;
  device.match = {"falcon", true, ""};
  device.node = "/dev/somewhere";
  device.access = NodeAccess::denied;
  return device;
}

/// Short items of a report descriptor whose values are never a PID page's.
std::vector<std::uint8_t> random_items(std::mt19937& random, int count) {
  std::vector<std::uint8_t> items;
  for (int i = 0; i < count; ++i) {
    const auto code = static_cast<std::uint8_t>(random() % 4);
    const auto tag = static_cast<std::uint8_t>(random() % 15 << 4U);
    const auto kind = static_cast<std::uint8_t>(random() % 3 << 2U);
    items.push_back(static_cast<std::uint8_t>(tag | kind | code));
    // Bytes that look like a usage page item of the PID page must be stepped over.
    for (int byte = 0; byte < (code == 3 ? 4 : code); ++byte) {
      items.push_back(byte % 2 == 0 ? 0x05 : 0x0F);
    }
  }
  return items;
}

}  // namespace

TEST_CASE("A Falcon is known by its USB ids, its bridge chip in other devices is not") {
  REQUIRE(driver_of(match_usb({0x0403, 0xCB48})) == "falcon");
  REQUIRE(driver_of(match_usb({0x0403, 0x6001})) == "none");
  REQUIRE(driver_of(match_usb({0xCB48, 0x0403})) == "none");
}

TEST_CASE("WoodenHaptics is known by ids, usage and name, since other boards have the same ids") {
  REQUIRE(driver_of_hid({0x1234, 0x0006}, 0xFFAB, 0x0200) == "woodenhaptics");
  REQUIRE(driver_of_hid({0x16C0, 0x0486}, 0xFFAB, 0x0200) == "woodenhaptics");
  REQUIRE(driver_of_hid({0x1234, 0x0006}, 0x0001, 0x0002) == "none");
  REQUIRE(driver_of_hid({0x16C0, 0x0486}, 0xFFC9, 0x0004) == "none");
  REQUIRE(driver_of_hid({0x1234, 0x0007}, 0xFFAB, 0x0200) == "none");
  REQUIRE(driver_of_hid({0x1234, 0x0006}, 0xFFAB, 0x0200, false, "Weather station") == "none");
  REQUIRE(driver_of_hid({0x16C0, 0x0486}, 0xFFAB, 0x0200, false, "Teensy") == "woodenhaptics");
}

TEST_CASE("A SpaceMouse is its multi-axis interface, never a mouse or keyboard of the same maker") {
  for (const auto product : std::initializer_list<std::uint16_t>{0xC603, 0xC626, 0xC62B}) {
    REQUIRE(driver_of_hid({0x046D, product}, 1, 8) == "spacemouse");
    REQUIRE(driver_of_hid({0x046D, product}, 1, 6) == "none");
  }
  for (const auto product : std::initializer_list<std::uint16_t>{0xC62E, 0xC635, 0xC652}) {
    REQUIRE(driver_of_hid({0x256F, product}, 1, 8) == "spacemouse");
    REQUIRE(driver_of_hid({0x256F, product}, 1, 2) == "none");
  }
  REQUIRE(driver_of_hid({0x256F, 0xC650}, 1, 8) == "none");
  REQUIRE(driver_of_hid({0x046D, 0xC077}, 1, 8) == "none");
}

TEST_CASE("Any maker's device with constant force is for pid, unless it has a driver") {
  REQUIRE(driver_of_hid({0x1209, 0xFFB0}, 1, 4, true) == "pid");
  REQUIRE(driver_of_hid({0x1209, 0xFFB0}, 1, 4, false) == "none");
  REQUIRE(driver_of_hid({0x16C0, 0x0486}, 0xFFAB, 0x0200, true) == "woodenhaptics");
}

namespace {

bool has_force(const std::vector<std::uint8_t>& descriptor) { return has_pid_force(descriptor); }

}  // namespace

TEST_CASE("Constant force is found at any size of its page's and its own item") {
  CHECK(has_force({0x05, 0x0F, 0x09, 0x73}));
  CHECK(has_force({0x05, 0x01, 0x06, 0x0F, 0x00, 0x0A, 0x73, 0x00}));
  CHECK(has_force({0x07, 0x0F, 0x00, 0x00, 0x00, 0x09, 0x73}));
  CHECK(has_force({0x0B, 0x73, 0x00, 0x0F, 0x00}));
  CHECK(has_force({0xFE, 0x02, 0x00, 0x09, 0x09, 0x05, 0x0F, 0x09, 0x73}));
  // The page alone, as of a pad that rumbles; the usage of another page; a page that ends in 0x0F.
  CHECK_FALSE(has_force({0x05, 0x0F, 0x09, 0x21}));
  CHECK_FALSE(has_force({0x05, 0x0F, 0x05, 0x01, 0x09, 0x73}));
  CHECK_FALSE(has_force({0x06, 0x0F, 0xFF, 0x09, 0x73}));
  CHECK_FALSE(has_force({0x0B, 0x73, 0x00, 0x0E, 0x00}));
}

TEST_CASE("What only looks like constant force inside other items is none, in any descriptor") {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    CAPTURE(seed);
    std::mt19937 random(seed);
    // Random items may be usage pages themselves: 0x05, 0x0F05 and the like, never 0x0F.
    std::vector<std::uint8_t> items = random_items(random, 30);
    REQUIRE_FALSE(has_force(items));
    items.insert(items.end(), {0x05, 0x0F, 0x09});
    REQUIRE_FALSE(has_force(items));  // cut short
    items.push_back(0x73);
    REQUIRE(has_force(items));
  }
}

TEST_CASE("A long item that is cut short ends a descriptor") {
  CHECK_FALSE(has_force({0xFE}));
  CHECK_FALSE(has_force({0xFE, 0xFF, 0x00}));
  CHECK_FALSE(has_force({}));
}

TEST_CASE("A USB device is named by where it is plugged in, whatever lies below it in /sys") {
  REQUIRE(
      usb_name_of("/sys/devices/pci0000:00/0000:00:14.0/usb1/1-2/1-2:1.0/0003:1234:0006.0001") ==
      "1-2");
  REQUIRE(usb_name_of("/sys/devices/pci0000:00/usb3/3-1/3-1.4/3-1.4:1.1/0003:256F:C652.0009") ==
          "3-1.4");
  REQUIRE(usb_name_of("/sys/devices/virtual/misc/uhid/0003:256F:C635.0002").empty());
  REQUIRE(usb_name_of("").empty());
}

TEST_CASE("The udev line grants to the user at the machine, never to everybody") {
  for (const auto kind : {NodeKind::usb, NodeKind::hidraw, NodeKind::serial}) {
    const std::string rule = udev_rule(denied(kind, {0x256F, 0xC635}));
    CAPTURE(rule);
    REQUIRE(rule.find("TAG+=\"uaccess\"") != std::string::npos);
    REQUIRE(rule.find("MODE") == std::string::npos);
    REQUIRE(rule.find('\n') == std::string::npos);
  }
  REQUIRE(udev_rule(NodeKind::usb, {0x0403, 0xCB48}) ==
          "SUBSYSTEM==\"usb\", ENV{DEVTYPE}==\"usb_device\", ATTR{idVendor}==\"0403\", "
          "ATTR{idProduct}==\"cb48\", TAG+=\"uaccess\"");
  // Bluetooth has no attributes of USB: the ids are in the HID device's name, in capitals.
  REQUIRE(udev_rule(NodeKind::hidraw, {0x256F, 0xC63A}, false).find("*:256F:C63A.*") !=
          std::string::npos);
}

TEST_CASE("A device that may be opened has no cure, another says what to do") {
  FoundDevice device = denied(NodeKind::usb, {0x0403, 0xCB48});
  REQUIRE(cure_of(device).find(udev_rule(device)) != std::string::npos);
  REQUIRE(cure_of(device).find("udevadm control --reload") != std::string::npos);
  nlohmann::ordered_json json = to_json(device);
  REQUIRE(json["permitted"] == false);
  REQUIRE(json["udev_rule"] == udev_rule(device));
  REQUIRE(json["ids"] == "0403:cb48");
  REQUIRE(json["usb"].is_null());

  device.access = NodeAccess::missing;
  REQUIRE(cure_of(device).find(device.node) != std::string::npos);
  REQUIRE(to_json(device)["udev_rule"].is_null());

  device.access = NodeAccess::granted;
  REQUIRE(cure_of(device).empty());
  json = to_json(device);
  REQUIRE(json["permitted"] == true);
  REQUIRE(json["cure"].is_null());
  REQUIRE(json["udev_rule"].is_null());
  REQUIRE(json["device"] == "falcon");

  device.match.driven = false;
  REQUIRE(to_json(device)["device"].is_null());
}

TEST_CASE("A node's permission is that of the user who asks") {
  const TemporaryFolder folder;
  const std::string node = folder.file("node");
  REQUIRE(access_to(node) == NodeAccess::missing);
  std::ofstream(node) << "";
  REQUIRE(access_to(node) == NodeAccess::granted);
  REQUIRE(chmod(folder.path().c_str(), 0755) == 0);
  REQUIRE(chmod(node.c_str(), 0444) == 0);
  const AsNobody user;
  if (!user.works()) SPM_SKIP("root cannot become another user here");
  REQUIRE(access_to(node) == NodeAccess::denied);
}

TEST_CASE("Serial lines are found by their names, with the board's serial number") {
  const TemporaryFolder folder;
  const std::string lines = folder.file("dev/serial/by-id");
  std::filesystem::create_directories(lines);
  std::ofstream(lines + "/usb-Teensyduino_USB_Serial_7654321-if00") << "";
  std::ofstream(lines + "/usb-FTDI_FT232R_USB_UART_A1-if00-port0") << "";
  DeviceSearch search;
  find_serial_devices(folder.path(), search);
  REQUIRE(search.devices.size() == 1);
  const FoundDevice& device = search.devices.front();
  REQUIRE(std::string(device.match.driver) == "woodenhaptics");
  REQUIRE_FALSE(device.match.driven);
  REQUIRE(device.serial == "7654321");
  REQUIRE(device.node == "/dev/serial/by-id/usb-Teensyduino_USB_Serial_7654321-if00");
  REQUIRE(device.permitted());

  DeviceSearch none;
  find_serial_devices(folder.file("nowhere"), none);
  REQUIRE(none.devices.empty());
}

TEST_CASE("A device is told apart from its like by what its driver takes") {
  FoundDevice device;
  device.match = {"falcon", true, ""};
  REQUIRE(specification_of(device) == "falcon");
  device.usb = "1-2.3";
  device.serial = "A1B2";
  REQUIRE(specification_of(device) == "falcon:path=1-2.3");
  device.match.driver = "spacemouse";
  REQUIRE(specification_of(device) == "spacemouse:serial=A1B2");
  device.serial = "A1,B2";
  REQUIRE(specification_of(device) == "spacemouse");
}

TEST_CASE("Looking for devices ends well on any machine, and finds the same again") {
  const DeviceSearch first = find_devices();
  const DeviceSearch second = find_devices();
  REQUIRE(first.devices.size() == second.devices.size());
  for (std::size_t i = 0; i < first.devices.size(); ++i) {
    REQUIRE(first.devices[i].node == second.devices[i].node);
  }
}

TEST_CASE("auto is the first device that may be opened and whose strength is known, or simulated") {
  const auto found = [](const char* driver, bool driven, NodeAccess access) {
    FoundDevice device;
    device.match = {driver, driven, ""};
    device.usb = "1-2";
    device.access = access;
    return device;
  };
  DeviceSearch search;
  CHECK(first_of(search, "sim") == "sim");
  search.devices = {found("falcon", true, NodeAccess::denied),
                    found("woodenhaptics", false, NodeAccess::granted),
                    found("pid", true, NodeAccess::granted)};
  CHECK(first_of(search, "sim:profile=touch") == "sim:profile=touch");
  search.devices.push_back(found("falcon", true, NodeAccess::granted));
  search.devices.push_back(found("spacemouse", true, NodeAccess::granted));
  CHECK(first_of(search, "sim:profile=touch") == "falcon:path=1-2");
}

TEST_CASE("A board with ids that other projects' boards have too is listed, and auto takes none") {
  FoundDevice device;
  device.match = *match_hid({{0x16C0, 0x0486}, 0xFFAB, 0x0200, false, "Teensyduino RawHID"});
  device.access = NodeAccess::granted;
  CHECK(device.match.driven);
  CHECK(specification_of(device) == "woodenhaptics:protocol=v3");
  device.serial = "7654321";
  CHECK(specification_of(device) == "woodenhaptics:serial=7654321");
  DeviceSearch search;
  search.devices = {device};
  CHECK(first_of(search, "sim") == "sim");
  device.match = *match_hid({{0x1234, 0x0006}, 0xFFAB, 0x0200, false, "HID DEVICE"});
  search.devices.push_back(device);
  CHECK(first_of(search, "sim") == "woodenhaptics:serial=7654321");
}

}  // namespace device_finder_test
