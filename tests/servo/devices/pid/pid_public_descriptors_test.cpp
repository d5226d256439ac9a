// SPDX-License-Identifier: Apache-2.0
// The descriptors of public devices, which lie beside the project (SPM_SHARED).
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "servo/devices/base/device_ids.hpp"
#include "servo/devices/pid/pid_codec.hpp"
#include "servo/devices/pid/pid_layout.hpp"
#include "tests/support/skip.hpp"

namespace pid_public_descriptors_test {

using namespace spm::servo;
using Bytes = std::vector<std::uint8_t>;

namespace {

/// Empty where the descriptors are not there.
std::filesystem::path folder() {
  const char* named = std::getenv("SPM_SHARED");
  const std::filesystem::path shared = named != nullptr ? named : SPM_SHARED_FOLDER;
  const std::filesystem::path data = shared / "data" / "hid-descriptors";
  return std::filesystem::is_directory(data) ? data : std::filesystem::path();
}

Bytes descriptor(const std::string& name) {
  std::ifstream file(folder() / (name + ".hex"));
  Bytes bytes;
  for (std::string word; file >> word;) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(word, nullptr, 16)));
  }
  REQUIRE_FALSE(bytes.empty());
  return bytes;
}

tl::expected<PidLayout, std::string> layout_of(const std::string& name) {
  const auto parsed = parse_hid_descriptor(descriptor(name));
  REQUIRE(parsed);
  return find_pid_layout(*parsed);
}

struct Driven {
  const char* name;
  std::size_t axes;
  Bytes reset, stop_all, enable;  ///< Device Control, as it is sent
};

}  // namespace

TEST_CASE("Public devices are reset, stopped and enabled as their own firmware has it") {
  if (folder().empty()) SPM_SKIP("no data/hid-descriptors in SPM_SHARED");
  const std::vector<Driven> all{
      {"openffboard_1axis", 1, {0x0C, 0x08}, {0x0C, 0x04}, {0x0C, 0x01}},
      {"openffboard_2axis", 2, {0x0C, 0x08}, {0x0C, 0x04}, {0x0C, 0x01}},
      {"ms_sidewinder_ff2", 2, {0x0C, 0x04}, {0x0C, 0x03}, {0x0C, 0x01}},
      {"arduino_joystick_ffb_xy", 2, {0x0C, 0x04}, {0x0C, 0x03}, {0x0C, 0x01}},
      {"vjoy_device1", 2, {0x1C, 0x04}, {0x1C, 0x03}, {0x1C, 0x01}},
  };
  for (const Driven& device : all) {
    CAPTURE(device.name);
    CHECK(has_pid_force(descriptor(device.name)));
    const auto layout = layout_of(device.name);
    REQUIRE(layout);
    CHECK(layout->axes == device.axes);
    REQUIRE((layout->reset && layout->stop_all && layout->enable));
    CHECK(pid_control(*layout, *layout->reset).bytes == device.reset);
    CHECK(pid_control(*layout, *layout->stop_all).bytes == device.stop_all);
    CHECK(pid_control(*layout, *layout->enable).bytes == device.enable);
  }
}

TEST_CASE("A pad that only rumbles is no device of constant force") {
  if (folder().empty()) SPM_SKIP("no data/hid-descriptors in SPM_SHARED");
  CHECK_FALSE(has_pid_force(descriptor("xbox_one_s_bt_rumble_only")));
}

TEST_CASE("A device whose driver manages its memory of effects is refused, and that is said") {
  if (folder().empty()) SPM_SKIP("no data/hid-descriptors in SPM_SHARED");
  const auto layout = layout_of("saitek_cyborg_evo_force");
  REQUIRE_FALSE(layout);
  CHECK_THAT(layout.error(), Catch::Contains("memory of effects"));
}

}  // namespace pid_public_descriptors_test
