// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/sim_options.hpp"

#include <catch2/catch.hpp>

namespace sim_options_test {

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

TEST_CASE("The plant's options are read, and by default it is plain") {
  const auto plain = parse_sim_options("");
  REQUIRE(plain);
  REQUIRE(plain->hand_model == HandModel::spring);
  REQUIRE(plain->mass == MovingMass::constant);
  REQUIRE(plain->delay_ticks == 0);
  REQUIRE(plain->noise == 0);
  const auto options = parse_sim_options(
      "mass=device,profile=falcon,hand_model=arm,delay=1.5,jitter=0.2,lost=0.05,noise=5um");
  REQUIRE(options);
  REQUIRE(options->hand_model == HandModel::arm);
  REQUIRE(options->mass == MovingMass::falcon);
  REQUIRE(options->delay_ticks == 1.5);
  REQUIRE(options->jitter_ticks == 0.2);
  REQUIRE(options->lost_share == 0.05);
  REQUIRE(options->noise == Approx(5e-6));
}

TEST_CASE("A path without a word about the hand is a recorded hand") {
  const auto options = parse_sim_options("path=slide.txt");
  REQUIRE(options);
  REQUIRE(options->hand == HandKind::recorded);
  REQUIRE(options->path == "slide.txt");
}

TEST_CASE("A wrong option is a usage error that says what would do") {
  const auto [text, hint] = GENERATE(table<std::string, std::string>({
      {"colour=red", "profile, hand, path, depth, speed, seed"},
      {"profile=omega7", "low falcon touch omega3 wooden"},
      {"profile=", "low falcon touch omega3 wooden"},
      {"hand=wave", "slide, push, path or live"},
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
      {"hand_model=claw", "spring or arm"},
      {"mass=heavy", "constant or device"},
      {"mass=device", "falcon and wooden"},
      {"mass=device,profile=omega3", "falcon and wooden"},
      {"delay=1ms", "0 to 32"},
      {"delay=-1", "0 to 32"},
      {"delay=33", "0 to 32"},
      {"delay=nan", "0 to 32"},
      {"delay=", "0 to 32"},
      {"jitter=fast", "0 to 32"},
      {"lost=2", "0 to 1"},
      {"noise=0um", "out of range"},
      {"noise=5", "unit"},
      {"profile", "option=value"},
      {",", "option=value"},
  }));
  CAPTURE(text);
  const auto options = parse_sim_options(text);
  REQUIRE_FALSE(options);
  REQUIRE(options.error().code == spm::ExitCode::usage);
  REQUIRE(options.error().message.find(hint) != std::string::npos);
}

TEST_CASE("Turns and torque are left to the scene, or switched") {
  const auto options = parse_sim_options("");
  REQUIRE(options);
  CHECK_FALSE(options->turns);
  CHECK_FALSE(options->torque);
  CHECK(parse_sim_options("turns=on,torque=off")->torque == false);
  CHECK(parse_sim_options("torque=on")->torque == true);
  CHECK(parse_sim_options("profile=falcon,mass=device")->turns == false);
  for (const char* text :
       {"turns=yes", "torque=", "turns=off,torque=on", "profile=falcon,mass=device,turns=on"}) {
    INFO(text);
    const auto wrong = parse_sim_options(text);
    REQUIRE_FALSE(wrong);
    CHECK(wrong.error().code == spm::ExitCode::usage);
  }
}

}  // namespace sim_options_test
