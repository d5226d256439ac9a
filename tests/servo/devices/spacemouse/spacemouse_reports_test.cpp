// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/spacemouse/spacemouse_reports.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "common/base/random.hpp"

namespace spacemouse_reports_test {

using namespace spm;
using namespace spm::servo;

namespace {

using Bytes = std::vector<std::uint8_t>;
using Axes = std::array<double, 3>;

double largest(const Axes& axes) {
  return std::max({std::abs(axes[0]), std::abs(axes[1]), std::abs(axes[2])});
}

Bytes report(std::uint8_t id, const std::vector<int>& counts) {
  Bytes bytes{id};
  for (const int count : counts) {
    const auto bits = static_cast<std::uint16_t>(static_cast<std::int16_t>(count));
    bytes.push_back(static_cast<std::uint8_t>(bits & 0xFFU));
    bytes.push_back(static_cast<std::uint8_t>(bits >> 8U));
  }
  return bytes;
}

}  // namespace

TEST_CASE("A push to the right, up or towards the user is that in the world") {
  SpaceMouseState state;
  REQUIRE(take_spacemouse_report(report(1, {350, 0, 0}), state));
  REQUIRE(state.push == Axes{1, 0, 0});
  REQUIRE(take_spacemouse_report(report(1, {0, 350, 0}), state));
  REQUIRE(state.push == Axes{0, 0, 1});
  REQUIRE(take_spacemouse_report(report(1, {0, 0, -350}), state));
  REQUIRE(state.push == Axes{0, 1, 0});
  REQUIRE(state.twist == Axes{});
}

TEST_CASE("A twist is about the same axes, right-handed") {
  SpaceMouseState state;
  REQUIRE(take_spacemouse_report(report(2, {0, 0, -175}), state));
  REQUIRE(state.twist == Axes{0, 0.5, 0});
  REQUIRE(take_spacemouse_report(report(2, {70, 350, 0}), state));
  REQUIRE(state.twist == Axes{0.2, 0, 1});
  REQUIRE(state.push == Axes{});
}

TEST_CASE("The two layouts of report 1 are told apart by their length") {
  SpaceMouseState classic;
  REQUIRE(take_spacemouse_report(report(2, {0, 0, -350}), classic));
  REQUIRE(take_spacemouse_report(report(1, {350, 0, 0}), classic));
  REQUIRE(classic.push == Axes{1, 0, 0});
  REQUIRE(classic.twist == Axes{0, 1, 0});
  SpaceMouseState newer;
  REQUIRE(take_spacemouse_report(report(1, {350, 0, 0, 0, 0, -350}), newer));
  REQUIRE(newer.push == classic.push);
  REQUIRE(newer.twist == classic.twist);
}

TEST_CASE("No deflection exceeds 1, whatever is sent, and its sense is kept") {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    std::vector<int> counts;
    for (int j = 0; j < 6; ++j) counts.push_back(static_cast<int>(random.between(-32768, 32767)));
    SpaceMouseState state;
    REQUIRE(take_spacemouse_report(report(1, counts), state));
    REQUIRE(largest(state.push) <= 1);
    REQUIRE(largest(state.twist) <= 1);
    REQUIRE(state.push[0] * counts[0] >= 0);
    REQUIRE(state.push[1] * counts[2] <= 0);
    REQUIRE(state.push[2] * counts[1] >= 0);
  }
  SpaceMouseState state;
  REQUIRE(take_spacemouse_report(report(1, {500, -500, 32767}), state));
  REQUIRE(state.push == Axes{1, -1, -1});
}

TEST_CASE("Buttons are a bit each, the first in the lowest") {
  SpaceMouseState state;
  REQUIRE(take_spacemouse_report(Bytes{3, 1, 0}, state));
  REQUIRE(state.buttons == 1);
  REQUIRE(take_spacemouse_report(Bytes{3, 0x16, 0xF1, 0xC0, 0x07}, state));
  REQUIRE(state.buttons == 0x07C0F116U);
  REQUIRE(take_spacemouse_report(Bytes{3, 2, 0, 0, 0, 9, 9}, state));
  REQUIRE(state.buttons == 2);
  REQUIRE(take_spacemouse_report(Bytes{3, 0, 0}, state));
  REQUIRE(state.buttons == 0);
}

TEST_CASE("A wireless one tells its battery") {
  SpaceMouseState state;
  REQUIRE(state.battery_percent == -1);
  REQUIRE(take_spacemouse_report(Bytes{0x17, 83, 1}, state));
  REQUIRE(state.battery_percent == 83);
  REQUIRE(state.charging);
  REQUIRE(take_spacemouse_report(Bytes{0x17, 84, 0}, state));
  REQUIRE_FALSE(state.charging);
}

TEST_CASE("Other ids and wrong lengths change nothing") {
  SpaceMouseState state;
  REQUIRE(take_spacemouse_report(report(1, {10, 20, 30, 40, 50, 60}), state));
  const SpaceMouseState before = state;
  for (int id = 0; id < 256; ++id) {
    for (std::size_t size = 0; size < 20; ++size) {
      Bytes bytes(size + 1, 0xFF);
      bytes[0] = static_cast<std::uint8_t>(id);
      const bool known = (id == 1 && (size == 6 || size == 12)) || (id == 2 && size == 6) ||
                         (id == 3 && size >= 2 && size <= 6) || (id == 0x17 && size == 2);
      if (known) continue;
      REQUIRE_FALSE(take_spacemouse_report(bytes, state));
    }
  }
  REQUIRE_FALSE(take_spacemouse_report({}, state));
  REQUIRE(state.push == before.push);
  REQUIRE(state.twist == before.twist);
  REQUIRE(state.buttons == before.buttons);
}

}  // namespace spacemouse_reports_test
