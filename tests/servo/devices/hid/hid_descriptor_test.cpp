// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/hid/hid_descriptor.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <vector>

#include "common/base/random.hpp"
#include "tests/servo/devices/hid/pid_descriptors.hpp"

namespace hid_descriptor_test {

using namespace spm::servo;
using spm::Random;
using spm::test::DescriptorWriter;
using spm::test::PidStick;

namespace {

using Bytes = std::vector<std::uint8_t>;

HidDescriptor parsed(const Bytes& bytes) {
  const auto result = parse_hid_descriptor(bytes);
  if (!result) FAIL(to_string(result.error()));
  return *result;
}

HidFault fault_of(const Bytes& bytes) {
  const auto result = parse_hid_descriptor(bytes);
  REQUIRE_FALSE(result);
  REQUIRE(result.error().at <= bytes.size());
  REQUIRE_FALSE(to_string(result.error()).empty());
  return result.error().fault;
}

/// Checks that hold for any descriptor that was read, whatever its source.
void check_bounds(const HidDescriptor& descriptor) {
  REQUIRE(descriptor.fields.size() <= max_descriptor_fields);
  for (const HidReport& report : descriptor.reports) REQUIRE(report.bits <= max_report_bits);
  for (std::size_t i = 0; i < descriptor.collections.size(); ++i) {
    REQUIRE(descriptor.collections[i].parent < static_cast<int>(i));
  }
  const auto collections = static_cast<int>(descriptor.collections.size());
  for (const HidField& field : descriptor.fields) {
    const bool within = field.bits >= 1 && field.bits <= 32 && field.collection < collections &&
                        !field.usages.empty() && field.usages.size() <= max_array_usages &&
                        std::any_of(descriptor.reports.begin(), descriptor.reports.end(),
                                    [&field](const HidReport& report) {
                                      return report.type == field.type &&
                                             report.id == field.report_id &&
                                             field.bit + field.bits <= report.bits;
                                    });
    REQUIRE(within);
  }
}

const HidField& field_of(const HidDescriptor& descriptor, HidReportType type, std::uint8_t id,
                         HidUsage usage) {
  for (const HidField& field : descriptor.fields) {
    if (field.type == type && field.report_id == id && field.usages.front() == usage) return field;
  }
  FAIL("no such field");
  return descriptor.fields.front();
}

std::uint32_t bits_of(const HidDescriptor& descriptor, HidReportType type, std::uint8_t id) {
  for (const HidReport& report : descriptor.reports) {
    if (report.type == type && report.id == id) return report.bits;
  }
  return 0;
}

}  // namespace

TEST_CASE("A stick's input report has its axes and buttons where its descriptor puts them") {
  const HidDescriptor stick = parsed(spm::test::pid_descriptor(PidStick::polar));
  REQUIRE(stick.has_ids);
  const HidField& x = field_of(stick, HidReportType::input, 1, hid_usage(1, 0x30));
  const HidField& y = field_of(stick, HidReportType::input, 1, hid_usage(1, 0x31));
  REQUIRE(x.bit == 0);
  REQUIRE(y.bit == 16);
  REQUIRE(y.bits == 16);
  REQUIRE(y.logical_min == -32767);
  REQUIRE(y.logical_max == 32767);
  for (std::uint16_t button = 1; button <= 8; ++button) {
    const HidField& field = field_of(stick, HidReportType::input, 1, hid_usage(9, button));
    REQUIRE(field.bit == 31U + button);
    REQUIRE(field.bits == 1);
  }
  REQUIRE(bits_of(stick, HidReportType::input, 1) == 40);
  REQUIRE(stick.is_within(x, hid_usage(1, 1)));
  REQUIRE(stick.is_within(x, hid_usage(1, 4)));
  REQUIRE_FALSE(stick.is_within(x, hid_usage(0x0F, 0x21)));
}

TEST_CASE(
    "A stick's effect report has times with their unit, bits, and arrays with their choices") {
  const HidDescriptor stick = parsed(spm::test::pid_descriptor(PidStick::polar));
  const auto out = [&stick](std::uint8_t id, HidUsage usage) {
    return field_of(stick, HidReportType::output, id, usage);
  };
  const HidField type = out(0x11, hid_usage(0x0F, 0x27));
  REQUIRE(type.is_array);
  REQUIRE(type.bit == 8);
  REQUIRE(type.usages == std::vector<HidUsage>{hid_usage(0x0F, 0x27), hid_usage(0x0F, 0x26),
                                               hid_usage(0x0F, 0x40)});
  const HidField duration = out(0x11, hid_usage(0x0F, 0x50));
  REQUIRE(duration.bit == 16);
  REQUIRE(duration.unit == 0x1003);
  REQUIRE(duration.unit_exponent == -3);
  REQUIRE(duration.physical_max == 32767);
  REQUIRE(out(0x11, hid_usage(0x0F, 0xA7)).bit == 64);
  // What was pushed before the times is popped after them.
  REQUIRE(out(0x11, hid_usage(0x0F, 0x52)).unit == 0);
  REQUIRE(out(0x11, hid_usage(0x0F, 0x52)).physical_max == 0);
  REQUIRE(out(0x11, hid_usage(0x0F, 0x52)).bit == 80);
  REQUIRE(out(0x11, hid_usage(0x01, 0x31)).bit == 97);
  REQUIRE(out(0x11, hid_usage(0x0F, 0x56)).bit == 98);
  // A usage of four bytes brings its page.
  REQUIRE(out(0x11, hid_usage(0x0A, 2)).bit == 120);
  REQUIRE(out(0x11, hid_usage(0x0A, 2)).logical_max == 36000);
  REQUIRE(bits_of(stick, HidReportType::output, 0x11) == 136);
  const HidField magnitude = out(0x15, hid_usage(0x0F, 0x70));
  REQUIRE(magnitude.bit == 8);
  REQUIRE(magnitude.logical_min == -10000);
  REQUIRE(magnitude.logical_max == 10000);
}

TEST_CASE("Reports of one id and different types are told apart") {
  const HidDescriptor stick = parsed(spm::test::pid_descriptor(PidStick::polar));
  REQUIRE(bits_of(stick, HidReportType::output, 0x11) == 136);
  REQUIRE(bits_of(stick, HidReportType::feature, 0x11) == 24);
  REQUIRE(bits_of(stick, HidReportType::input, 0x11) == 0);
}

TEST_CASE("Without report ids there is one report of each type, and the last usage repeats") {
  DescriptorWriter w;
  w.page(0xFF).begin(1, 1).usages({5, 6}).logical(0, 255).size(8, 4).input(2).end();
  const HidDescriptor descriptor = parsed(w.bytes());
  REQUIRE_FALSE(descriptor.has_ids);
  REQUIRE(descriptor.fields.size() == 4);
  REQUIRE(descriptor.fields[0].usages.front() == hid_usage(0xFF, 5));
  REQUIRE(descriptor.fields[3].usages.front() == hid_usage(0xFF, 6));
  REQUIRE(descriptor.fields[3].bit == 24);
  REQUIRE(descriptor.fields[3].logical_max == 255);
}

TEST_CASE("An upper limit has a sign where the lower one has") {
  const HidDescriptor descriptor =
      parsed({0x05, 0x01, 0x09, 0x30, 0x15, 0x00, 0x25, 0xFF, 0x75, 0x08, 0x95,
              0x01, 0x81, 0x02, 0x09, 0x31, 0x15, 0x81, 0x25, 0x7F, 0x81, 0x02});
  REQUIRE(descriptor.fields[0].logical_max == 255);
  REQUIRE(descriptor.fields[1].logical_min == -127);
  REQUIRE(descriptor.fields[1].logical_max == 127);
}

TEST_CASE("Constants and values that are too wide keep their room, and the next field its place") {
  DescriptorWriter w;
  w.page(1).usages({0x30}).size(3, 1).input(3).usages({0x31}).size(64, 1).input(2);
  w.usages({0x32}).size(5, 1).input(2);
  const HidDescriptor descriptor = parsed(w.bytes());
  REQUIRE(descriptor.fields.size() == 1);
  REQUIRE(descriptor.fields[0].bit == 67);
  REQUIRE(bits_of(descriptor, HidReportType::input, 0) == 72);
}

TEST_CASE("Long and reserved items are stepped over, and of delimited usages the first counts") {
  DescriptorWriter w;
  w.page(1).add({0xFE, 2, 0x99, 0x09, 0x31}).add({0xFD, 0x09, 0x32});
  w.add({0xA9, 1}).usages({0x30, 0x33}).add({0xA9, 0}).logical(0, 1).size(8, 1).input(2);
  const HidDescriptor descriptor = parsed(w.bytes());
  REQUIRE(descriptor.fields.size() == 1);
  REQUIRE(descriptor.fields[0].usages == std::vector<HidUsage>{hid_usage(1, 0x30)});
}

TEST_CASE("A descriptor that makes no sense is an error that says where") {
  REQUIRE(fault_of(Bytes(max_descriptor_bytes + 1, 0x05)) == HidFault::too_long);
  REQUIRE(fault_of({0x05}) == HidFault::cut_short);
  REQUIRE(fault_of({0x27, 0, 0, 0}) == HidFault::cut_short);
  REQUIRE(fault_of({0xFE}) == HidFault::cut_short);
  REQUIRE(fault_of({0xFE, 4, 0, 1, 2}) == HidFault::cut_short);
  REQUIRE(fault_of({0x85, 0x00}) == HidFault::bad_report_id);
  REQUIRE(fault_of({0x86, 0x00, 0x01}) == HidFault::bad_report_id);
  REQUIRE(fault_of({0xC0}) == HidFault::not_nested);
  REQUIRE(fault_of({0xA1, 0x01}) == HidFault::not_nested);
  REQUIRE(fault_of({0xB4}) == HidFault::popped_too_often);
  REQUIRE(fault_of(Bytes(max_pushes + 1, 0xA4)) == HidFault::pushed_too_often);
  REQUIRE(fault_of({0x77, 0xFF, 0xFF, 0xFF, 0xFF, 0x97, 0xFF, 0xFF, 0xFF, 0xFF, 0x81, 0x02}) ==
          HidFault::report_too_long);
  Bytes deep;
  for (std::size_t i = 0; i <= max_collection_depth; ++i) deep.insert(deep.end(), {0xA1, 0x00});
  REQUIRE(fault_of(deep) == HidFault::nested_too_deep);
  REQUIRE(fault_of({0x09, 0x01, 0x75, 0x01, 0x96, 0x00, 0x70, 0x81, 0x02}) ==
          HidFault::too_many_fields);
}

TEST_CASE("Any bytes give a descriptor within its bounds, or an error") {
  int read = 0;
  for (std::uint64_t seed = 1; seed <= 4000; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    Bytes bytes(random.next() % 200);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.next());
    const auto result = parse_hid_descriptor(bytes);
    if (result) {
      check_bounds(*result);
      ++read;
    } else {
      REQUIRE(result.error().at <= bytes.size());
    }
  }
  REQUIRE(read > 10);
}

TEST_CASE("A stick's descriptor with bytes changed, lost or added is read within its bounds") {
  const Bytes good = spm::test::pid_descriptor(PidStick::polar);
  int read = 0;
  for (std::uint64_t seed = 1; seed <= 4000; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    Bytes bytes = good;
    for (std::uint64_t change = 0; change < 1 + seed % 4; ++change) {
      const auto at = static_cast<std::ptrdiff_t>(random.next() % bytes.size());
      switch (random.next() % 3) {
        case 0:
          bytes[static_cast<std::size_t>(at)] = static_cast<std::uint8_t>(random.next());
          break;
        case 1:
          bytes.erase(bytes.begin() + at);
          break;
        default:
          bytes.insert(bytes.begin() + at, static_cast<std::uint8_t>(random.next()));
          break;
      }
    }
    const auto result = parse_hid_descriptor(bytes);
    if (!result) continue;
    check_bounds(*result);
    ++read;
  }
  REQUIRE(read > 100);
}

}  // namespace hid_descriptor_test
