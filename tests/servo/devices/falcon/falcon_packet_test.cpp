// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/falcon/falcon_packet.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "common/base/random.hpp"

namespace falcon_packet_test {

using namespace spm::servo;
using spm::Random;

namespace {

std::string text(const std::array<std::uint8_t, falcon_packet_size>& packet) {
  return {packet.begin(), packet.end()};
}

/// A device's packet, written from the protocol's description alone.
std::string device_packet(const std::array<int, 3>& encoders, unsigned buttons, unsigned homed) {
  std::string packet = "<";
  for (const int encoder : encoders) {
    const auto bits = static_cast<unsigned>(encoder) & 0xFFFFU;
    for (const unsigned shift : {0U, 4U, 8U, 12U}) {
      packet += static_cast<char>('A' + ((bits >> shift) & 15U));
    }
  }
  packet += static_cast<char>('A' + (buttons | homed << 4U));
  return packet + "A>";
}

std::vector<FalconReport> parse(FalconParser& parser, const std::string& bytes) {
  std::vector<FalconReport> reports;
  for (const char byte : bytes) {
    if (const auto report = parser.take(static_cast<std::uint8_t>(byte))) {
      reports.push_back(*report);
    }
  }
  return reports;
}

std::vector<FalconReport> parse(const std::string& bytes) {
  FalconParser parser;
  return parse(parser, bytes);
}

int random_count(Random& random) { return static_cast<int>(random.next() % 65536) - 32768; }

}  // namespace

TEST_CASE("A command of nothing is the known null packet, but for the homing bit") {
  FalconCommand command;
  command.homing = false;
  REQUIRE(text(encode(command)) == "<AAAAAAAAAAAAAA>");
  command.homing = true;
  REQUIRE(text(encode(command)) == "<AAAAAAAAAAAABA>");
}

TEST_CASE("Every light has its bit") {
  const auto flags = [](bool red, bool green, bool blue) {
    FalconCommand command;
    command.homing = false;
    command.red = red;
    command.green = green;
    command.blue = blue;
    return text(encode(command))[13] - 'A';
  };
  REQUIRE(flags(false, true, false) == 2);
  REQUIRE(flags(false, false, true) == 4);
  REQUIRE(flags(true, false, false) == 8);
  REQUIRE(flags(true, true, true) == 14);
}

TEST_CASE("Motors are written lowest nibble first, and never beyond their limit") {
  FalconCommand command;
  command.motors = {-1447, 4096, 1};
  REQUIRE(text(encode(command)).substr(0, 13) == "<JFKPAAABBAAA");
  FalconCommand beyond;
  beyond.motors = {32767, -32768, 4097};
  FalconCommand limit;
  limit.motors = {4096, -4096, 4096};
  REQUIRE(text(encode(beyond)) == text(encode(limit)));
}

TEST_CASE("The worked example of the protocol decodes") {
  const auto reports = parse(
      "<\x4A\x46\x4B\x50"
      "AAAAAAAAAA>");
  REQUIRE(reports.size() == 1);
  REQUIRE(reports[0].encoders == std::array<std::int16_t, 3>{-1447, 0, 0});
}

TEST_CASE("Any report comes through whole, buttons and homed bits apart") {
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const std::array<int, 3> encoders{random_count(random), random_count(random),
                                      random_count(random)};
    const auto buttons = static_cast<unsigned>(random.next() % 16);
    const auto homed = static_cast<unsigned>(random.next() % 8);
    const auto reports = parse(device_packet(encoders, buttons, homed));
    REQUIRE(reports.size() == 1);
    for (std::size_t k = 0; k < 3; ++k) REQUIRE(reports[0].encoders[k] == encoders[k]);
    REQUIRE(reports[0].buttons == buttons);
    REQUIRE(reports[0].homed == homed);
  }
}

TEST_CASE("A packet that was cut short costs itself alone") {
  const std::string whole = device_packet({100, -200, 300}, 5, 7);
  for (std::size_t kept = 0; kept < falcon_packet_size; ++kept) {
    CAPTURE(kept);
    FalconParser parser;
    const auto reports = parse(parser, whole.substr(0, kept) + whole + whole);
    REQUIRE(reports.size() == 2);
    REQUIRE(parser.dropped() == kept);
    for (const FalconReport& report : reports) {
      REQUIRE(report.encoders == std::array<std::int16_t, 3>{100, -200, 300});
      REQUIRE(report.buttons == 5);
      REQUIRE(report.homed == 7);
    }
  }
}

TEST_CASE("Bytes that no packet can hold are no report") {
  const std::string whole = device_packet({1, 2, 3}, 0, 7);
  for (std::size_t at = 0; at < falcon_packet_size; ++at) {
    if (at == 13 || at == 14) continue;  // these may be anything
    for (const char wrong : {'@', 'Q', '\0', '\xFF', at == 0 ? '>' : '<'}) {
      CAPTURE(at, int{wrong});
      std::string damaged = whole;
      damaged[at] = wrong;
      REQUIRE(parse(damaged).empty());
    }
  }
}

TEST_CASE("After any rubbish the next whole packets are found, and nothing else") {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    FalconParser parser;
    std::string rubbish;
    for (std::uint64_t i = random.next() % 100; i > 0; --i) {
      // Every byte but the end mark, so that no packet lies in it by chance.
      const auto byte = static_cast<char>(random.next() % 256);
      rubbish += byte == '>' ? '<' : byte;
    }
    REQUIRE(parse(parser, rubbish).empty());
    const std::string packets = device_packet({7, 8, 9}, 1, 7) + device_packet({10, 11, 12}, 2, 7);
    const auto reports = parse(parser, packets);
    REQUIRE(reports.size() == 2);
    REQUIRE(reports.front().encoders == std::array<std::int16_t, 3>{7, 8, 9});
    REQUIRE(reports.back().encoders == std::array<std::int16_t, 3>{10, 11, 12});
    for (const FalconReport& report : reports) REQUIRE(report.homed == 7);
  }
}

TEST_CASE("A parser that is reset forgets the packet it was in") {
  const std::string whole = device_packet({1, 2, 3}, 0, 7);
  FalconParser parser;
  REQUIRE(parse(parser, whole.substr(0, 10)).empty());
  parser.reset();
  REQUIRE(parse(parser, whole.substr(10)).empty());
  REQUIRE(parse(parser, whole).size() == 1);
}

}  // namespace falcon_packet_test
