// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/wooden/wooden_reports.hpp"

#include <catch2/catch.hpp>
#include <limits>
#include <vector>

#include "common/base/random.hpp"

namespace wooden_reports_test {

using namespace spm::servo;
using spm::Random;

namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes bytes_of(const WoodenPacket& packet) {
  return {packet.bytes().begin(), packet.bytes().end()};
}

constexpr std::array protocols{WoodenProtocol::v1, WoodenProtocol::v2, WoodenProtocol::v3};

}  // namespace

TEST_CASE("A V1 report is three counters and a running number") {
  const Bytes bytes{0x01, 0x00, 0xFE, 0xFF, 0x70, 0x17, 0xFF, 0xFF};
  WoodenReport report;
  report.connection = 7;
  REQUIRE(decode_wooden_report(WoodenProtocol::v1, bytes, report));
  REQUIRE(report.counters == std::array<std::int16_t, 6>{1, -2, 6000, 0, 0, 0});
  REQUIRE(report.sequence == 65535);
  REQUIRE_FALSE(report.calibration_pressed);
  REQUIRE(report.protocol == WoodenProtocol::v1);
  REQUIRE(report.connection == 7);
}

TEST_CASE("A V2 report is six counters and whether the calibration button was pressed") {
  Bytes bytes{0x00, 0x80, 0xFF, 0x7F, 3, 0, 4, 0, 5, 0, 0xFA, 0xFF, 1, 0};
  WoodenReport report;
  REQUIRE(decode_wooden_report(WoodenProtocol::v2, bytes, report));
  REQUIRE(report.counters == std::array<std::int16_t, 6>{-32768, 32767, 3, 4, 5, -6});
  REQUIRE(report.calibration_pressed);
  REQUIRE(report.sequence == 0);
  bytes[12] = 0;
  REQUIRE(decode_wooden_report(WoodenProtocol::v2, bytes, report));
  REQUIRE_FALSE(report.calibration_pressed);

  bytes[12] = 1;
  bytes.resize(64, 0xAA);
  REQUIRE(decode_wooden_report(WoodenProtocol::v3, bytes, report));
  REQUIRE(report.counters == std::array<std::int16_t, 6>{-32768, 32767, 3, 4, 5, -6});
  REQUIRE(report.calibration_pressed);
  REQUIRE(report.protocol == WoodenProtocol::v3);
}

TEST_CASE("A report of any other length is none") {
  for (const WoodenProtocol protocol : protocols) {
    for (std::size_t size = 0; size <= 80; ++size) {
      WoodenReport report;
      const bool taken = decode_wooden_report(protocol, Bytes(size, 1), report);
      REQUIRE(taken == (size == wooden_report_bytes(protocol)));
    }
  }
}

TEST_CASE("Currents are written behind the report id 0, padded with zeros") {
  WoodenCommand command;
  command.currents = {1000, -2, -32768};
  const Bytes currents{0, 0xE8, 0x03, 0xFE, 0xFF, 0x00, 0x80};
  for (const auto& [protocol, size] : {std::pair{WoodenProtocol::v1, std::size_t{9}},
                                       {WoodenProtocol::v2, 15},
                                       {WoodenProtocol::v3, 65}}) {
    Bytes expected = currents;
    expected.resize(size);
    REQUIRE(bytes_of({protocol, command}) == expected);
  }
}

TEST_CASE("New counters are written as command 1, D to F before A to C") {
  WoodenCommand command;
  command.request = WoodenRequest::set_counters;
  command.currents = {9, 9, 9};
  command.counters = {1, 2, 3, 4, -5, 6};
  Bytes expected{0, 4, 0, 0xFB, 0xFF, 6, 0, 1, 0, 1, 0, 2, 0, 3, 0};
  REQUIRE(bytes_of({WoodenProtocol::v2, command}) == expected);
  expected.resize(65);
  REQUIRE(bytes_of({WoodenProtocol::v3, command}) == expected);
}

TEST_CASE("V1 cannot set counters, and gives no current instead") {
  WoodenCommand command;
  command.request = WoodenRequest::set_counters;
  command.currents = {9, 9, 9};
  command.counters = {1, 2, 3, 4, 5, 6};
  REQUIRE(bytes_of({WoodenProtocol::v1, command}) == Bytes(9, 0));
}

TEST_CASE("No current exceeds its limit, whatever is asked") {
  Random random(1);
  for (int i = 0; i < 10000; ++i) {
    const double limit = random.between(0, 6);
    const double asked = random.between(-20, 20);
    const int given = limited_milliamperes(asked, limit);
    REQUIRE(std::abs(given) <= limit * 1000);
    REQUIRE(std::abs(given) <= std::abs(asked) * 1000);
    REQUIRE(given * asked >= 0);
    if (std::abs(asked) <= limit - 1e-3) REQUIRE(std::abs(given - asked * 1000) < 1);
  }
  REQUIRE(limited_milliamperes(5, 2) == 2000);
  REQUIRE(limited_milliamperes(-5, 2) == -2000);
  REQUIRE(limited_milliamperes(1e300, 1e300) == 32767);
}

TEST_CASE("What is no number is no current") {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const double endless = std::numeric_limits<double>::infinity();
  REQUIRE(limited_milliamperes(none, 2) == 0);
  REQUIRE(limited_milliamperes(endless, 2) == 0);
  REQUIRE(limited_milliamperes(-endless, 2) == 0);
  REQUIRE(limited_milliamperes(1, none) == 0);
  REQUIRE(limited_milliamperes(1, -2) == 0);
}

TEST_CASE("The handle's button adds 10000 to encoder D") {
  REQUIRE_FALSE(wooden_handle(5000).pressed);
  REQUIRE(wooden_handle(5000).counter == 5000);
  REQUIRE(wooden_handle(5001).pressed);
  for (const int count : {-1024, 0, 1023}) {
    const WoodenHandle handle = wooden_handle(static_cast<std::int16_t>(count + 10000));
    REQUIRE(handle.pressed);
    REQUIRE(handle.counter == count);
  }
}

}  // namespace wooden_reports_test
