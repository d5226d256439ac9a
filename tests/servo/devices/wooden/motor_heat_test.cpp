// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/wooden/motor_heat.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "servo/devices/wooden/wooden_tracker.hpp"

namespace motor_heat_test {

using namespace spm;
using namespace spm::servo;

namespace {

/// No motor's: round numbers.
MotorData some_motor() { return {1, 10, 20, 125, 25, "a test"}; }

}  // namespace

TEST_CASE(
    "A winding without current stays as warm as the air, and without data nothing is limited") {
  MotorHeat heat;
  heat.add(some_motor(), 0, 100);
  REQUIRE(heat.temperature(some_motor()) == 25);
  MotorHeat unknown;
  unknown.add({}, 100, 100);
  REQUIRE(unknown.share({}) == 1);
}

TEST_CASE("A winding warms by the current squared, with its time constant") {
  MotorHeat heat;
  heat.add(some_motor(), 1, 20);
  // 10 K/W times 1 W, after one time constant, with the cold winding's resistance.
  REQUIRE(heat.temperature(some_motor()) == Approx(25 + 10 * (1 - std::exp(-1.0))));
  MotorHeat warmer;
  warmer.add(some_motor(), 2, 20);
  REQUIRE(warmer.temperature(some_motor()) - 25 ==
          Approx(4 * (heat.temperature(some_motor()) - 25)));
}

TEST_CASE("A limited winding never comes to its limit, however long and strong it is pushed") {
  const MotorData motor = some_motor();
  for (const double current : {3.0, 6.0, 50.0}) {
    MotorHeat heat;
    double last = 1, largest_step = 0;
    for (int tick = 0; tick < 200'000; ++tick) {
      const double share = heat.share(motor);
      largest_step = std::max(largest_step, std::abs(share - last));
      last = share;
      heat.add(motor, share * current, 1e-3);
    }
    CAPTURE(current);
    REQUIRE(heat.share(motor) < 1);
    REQUIRE(heat.share(motor) > 0);
    REQUIRE(heat.hottest(motor) < motor.winding_limit);
    // A force that is felt changes smoothly.
    if (current < 10) REQUIRE(largest_step < 0.01);
  }
}

TEST_CASE("The arm's force is lowered in all motors alike where one is hot, and comes back") {
  WoodenOptions options = *parse_wooden_options(
      "home_confirmed=always,signs=+++,motor_resistance=1ohm,thermal_resistance=10K/"
      "W,thermal_time=1s,"
      "winding_limit=45C,motor_source=a test");
  WoodenTracker tracker(options);
  WoodenReport report;
  report.protocol = WoodenProtocol::v2;
  std::int64_t now = 0;
  const auto currents_of = [&](double force) {
    now += 1'000'000;
    tracker.take(report, now);
    WoodenCommand command;
    REQUIRE(tracker.command({{0, force, 0}, Vector3::Zero()}, now, command));
    return command.currents;
  };
  const auto cold = currents_of(5);
  auto hot = cold;
  for (int tick = 0; tick < 20'000; ++tick) hot = currents_of(5);
  REQUIRE(tracker.limited_commands() > 0);
  REQUIRE(tracker.hottest() < 45);
  const auto stronger = [](std::int16_t a, std::int16_t b) { return std::abs(a) < std::abs(b); };
  const auto strongest =
      static_cast<std::size_t>(std::max_element(cold.begin(), cold.end(), stronger) - cold.begin());
  const double share = static_cast<double>(hot[strongest]) / cold[strongest];
  REQUIRE(share < 0.95);
  for (std::size_t i = 0; i < 3; ++i) REQUIRE(std::abs(hot[i] - share * cold[i]) < 2);
  for (int tick = 0; tick < 10'000; ++tick) static_cast<void>(currents_of(0));
  REQUIRE(currents_of(5) == cold);
}

TEST_CASE("A motor's data are given whole, with units and a source, or not at all") {
  REQUIRE_FALSE(parse_wooden_options("")->motor.known());
  const auto whole = parse_wooden_options(
      "motor_resistance=2.5ohm,thermal_resistance=8K/W,thermal_time=16s,winding_limit=125C,"
      "ambient=30C,motor_source=data sheet");
  REQUIRE(whole);
  REQUIRE(whole->motor.resistance == 2.5);
  REQUIRE(whole->motor.thermal_resistance == 8);
  REQUIRE(whole->motor.time_constant == 16);
  REQUIRE(whole->motor.winding_limit == 125);
  REQUIRE(whole->motor.ambient == 30);
  REQUIRE(whole->motor.source == "data sheet");
  const auto part = parse_wooden_options("motor_resistance=2.5ohm");
  REQUIRE_FALSE(part);
  REQUIRE(part.error().message.find("belong together") != std::string::npos);
  for (const char* wrong : {"motor_resistance=2.5", "motor_resistance=-1ohm", "thermal_time=nans",
                            "winding_limit=9999C", "thermal_resistance=8W/K"}) {
    CAPTURE(wrong);
    REQUIRE_FALSE(parse_wooden_options(wrong));
  }
  REQUIRE_FALSE(parse_wooden_options(
      "motor_resistance=2.5ohm,thermal_resistance=8K/W,thermal_time=16s,winding_limit=30C,"
      "ambient=40C,motor_source=x"));
}

}  // namespace motor_heat_test
