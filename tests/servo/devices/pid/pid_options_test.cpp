// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/pid/pid_options.hpp"

#include <catch2/catch.hpp>

namespace pid_options_test {

using namespace spm::servo;

TEST_CASE("A pid device is asked for its full force, which nobody else can tell") {
  const auto none = parse_pid_options("");
  REQUIRE_FALSE(none);
  REQUIRE(none.error().code == spm::ExitCode::usage);
  REQUIRE(none.error().message.find("full_force=8N") != std::string::npos);
  const auto options = parse_pid_options("full_force=8N");
  REQUIRE(options);
  REQUIRE(options->full_force == 8);
  REQUIRE(options->force_cap == 8);
  REQUIRE(options->travel == 0.1);
  REQUIRE(options->watchdog);
  REQUIRE_FALSE(options->direction);
  REQUIRE(options->force_signs == std::array<double, 2>{1, 1});
}

TEST_CASE("A strong pid device is held to what the strongest haptic device gives") {
  REQUIRE(parse_pid_options("full_force=100N")->force_cap == 12);
}

TEST_CASE("Every pid option is read with its unit") {
  const auto options = parse_pid_options(
      "full_force=9500mN,force_cap=4N,travel=80mm,force_signs=-+,direction=axes,watchdog=off,"
      "serial=A 7");
  REQUIRE(options);
  REQUIRE(options->full_force == 9.5);
  REQUIRE(options->force_cap == 4);
  REQUIRE(options->travel == Approx(0.08));
  REQUIRE(options->force_signs == std::array<double, 2>{-1, 1});
  REQUIRE(options->direction == PidDirection::axes);
  REQUIRE_FALSE(options->watchdog);
  REQUIRE(options->serial == "A 7");
}

TEST_CASE("A wrong pid option is a usage error that says what would do") {
  const auto [text, hint] = GENERATE(table<std::string, std::string>({
      {"full_force=8", "N"},
      {"full_force=0N", "above 0"},
      {"full_force=8N,force_cap=9N", "full_force"},
      {"full_force=40N,force_cap=13N", "12 N"},
      {"full_force=8N,travel=2m", "1 m"},
      {"full_force=8N,force_signs=+", "each of x and y"},
      {"full_force=8N,force_signs=+*", "each of x and y"},
      {"full_force=8N,direction=north", "polar, cartesian or axes"},
      {"full_force=8N,watchdog=1", "on or off"},
      {"full_force=8N,serial=", "spm-servo devices"},
      {"force=8N", "full_force, force_cap, travel"},
      {"full_force", "option=value"},
  }));
  CAPTURE(text);
  const auto options = parse_pid_options(text);
  REQUIRE_FALSE(options);
  REQUIRE(options.error().code == spm::ExitCode::usage);
  REQUIRE(options.error().message.find(hint) != std::string::npos);
}

}  // namespace pid_options_test
