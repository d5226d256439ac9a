// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/sim_options.hpp"

#include <catch2/catch.hpp>

using namespace spm::servo;

TEST_CASE("Without options the hand slides, 1 mm deep at 40 mm/s") {
  const auto options = parse_sim_options("");
  REQUIRE(options);
  REQUIRE(options->hand == HandKind::slide);
  REQUIRE(options->depth == 1e-3);
  REQUIRE(options->speed == 0.04);
}

TEST_CASE("Every option is read with its unit") {
  const auto options =
      parse_sim_options("profile=touch,hand=push,depth=500um,speed=20mm/s,seed=42");
  REQUIRE(options);
  REQUIRE(options->profile->name == "touch");
  REQUIRE(options->hand == HandKind::push);
  REQUIRE(options->depth == Approx(5e-4));
  REQUIRE(options->speed == Approx(0.02));
  REQUIRE(options->seed == 42);
}

TEST_CASE("A path without a word about the hand is a recorded hand") {
  const auto options = parse_sim_options("path=slide.txt");
  REQUIRE(options);
  REQUIRE(options->hand == HandKind::recorded);
  REQUIRE(options->path == "slide.txt");
}

TEST_CASE("A wrong option is a usage error that says what would do") {
  const auto [text, hint] = GENERATE(table<std::string, std::string>({
      {"colour=red", "profile, hand, path, depth, speed and seed"},
      {"profile=omega7", "low falcon touch omega3 wooden"},
      {"profile=", "low falcon touch omega3 wooden"},
      {"hand=wave", "slide, push or path"},
      {"hand=path", "path=FILE"},
      {"hand=slide,path=a.txt", "hand=path"},
      {"path=", "trajectory"},
      {"depth=1", "unit"},
      {"depth=0mm", "out of range"},
      {"depth=-1mm", "out of range"},
      {"depth=1m", "out of range"},
      {"depth=1mm/s", ""},
      {"speed=2m/s", "out of range"},
      {"speed=fast", ""},
      {"seed=-1", "whole number"},
      {"seed=1.5", "whole number"},
      {"seed=", "whole number"},
      {"profile", "option=value"},
      {",", "option=value"},
  }));
  CAPTURE(text);
  const auto options = parse_sim_options(text);
  REQUIRE_FALSE(options);
  REQUIRE(options.error().code == spm::ExitCode::usage);
  REQUIRE(options.error().message.find(hint) != std::string::npos);
}
