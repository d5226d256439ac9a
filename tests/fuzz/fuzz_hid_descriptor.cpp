// SPDX-License-Identifier: Apache-2.0
// Report descriptors of HID devices of any bytes, and what a driver of the PID class makes of them.
#include "servo/devices/hid/hid_descriptor.hpp"
#include "servo/devices/pid/pid_layout.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/servo/devices/hid/pid_descriptors.hpp"

namespace spm::fuzz {

std::vector<std::string> seeds() {
  std::vector<std::string> made;
  for (const test::PidStick stick : {test::PidStick::polar, test::PidStick::no_constant,
                                     test::PidStick::axes, test::PidStick::cartesian}) {
    const std::vector<std::uint8_t> bytes = test::pid_descriptor(stick);
    made.emplace_back(bytes.begin(), bytes.end());
  }
  return made;
}

std::vector<std::string> endings() { return {".hid"}; }

}  // namespace spm::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace spm::servo;
  const auto descriptor = parse_hid_descriptor({data, size});
  if (!descriptor) {
    spm::fuzz::require(descriptor.error().at <= size, "a fault lies in the descriptor");
    return 0;
  }
  for (const HidField& field : descriptor->fields) {
    spm::fuzz::require(field.bits >= 1 && field.bits <= 32, "a field has 1 to 32 bits");
    spm::fuzz::require(field.bit + field.bits <= max_report_bits, "a field lies in its report");
  }
  const auto layout = find_pid_layout(*descriptor);
  spm::fuzz::require(layout || !layout.error().empty(), "a refusal says why");
  return 0;
}
