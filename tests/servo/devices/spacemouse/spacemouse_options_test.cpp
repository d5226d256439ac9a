// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/spacemouse/spacemouse_options.hpp"

#include <catch2/catch.hpp>
#include <numbers>

namespace spacemouse_options_test {

using namespace spm::servo;

TEST_CASE("Without options a SpaceMouse moves at 0.1 m/s and a quarter turn a second") {
  const auto options = parse_spacemouse_options("");
  REQUIRE(options);
  REQUIRE(options->speed == 0.1);
  REQUIRE(options->turn == Approx(std::numbers::pi / 2));
  REQUIRE(options->dead_zone == 0.05);
  REQUIRE(options->box == 0.45);
}

TEST_CASE("Every SpaceMouse option is read with its unit") {
  const auto options =
      parse_spacemouse_options("speed=50mm/s,turn=180deg/s,dead_zone=0%,box=300mm,serial=X1");
  REQUIRE(options);
  REQUIRE(options->speed == Approx(0.05));
  REQUIRE(options->turn == Approx(std::numbers::pi));
  REQUIRE(options->dead_zone == 0);
  REQUIRE(options->box == Approx(0.3));
  REQUIRE(options->serial == "X1");
}

TEST_CASE("A wrong SpaceMouse option is a usage error that says what would do") {
  const auto [text, hint] = GENERATE(table<std::string, std::string>({
      {"depth=1mm", "speed, turn, dead_zone, box and serial"},
      {"speed=0.1", "unit"},
      {"speed=2m/s", "out of range"},
      {"speed=0m/s", "out of range"},
      {"turn=90deg", "unit"},
      {"turn=10000deg/s", "out of range"},
      {"dead_zone=5", "5%"},
      {"dead_zone=100%", "below 100%"},
      {"dead_zone=-1%", "from 0%"},
      {"dead_zone=nan%", "5%"},
      {"box=-1m", "out of range"},
      {"serial=", "serial"},
      {"speed", "option=value"},
  }));
  CAPTURE(text);
  const auto options = parse_spacemouse_options(text);
  REQUIRE_FALSE(options);
  REQUIRE(options.error().code == spm::ExitCode::usage);
  REQUIRE(options.error().message.find("spacemouse") != std::string::npos);
  REQUIRE(options.error().message.find(hint) != std::string::npos);
}

}  // namespace spacemouse_options_test
