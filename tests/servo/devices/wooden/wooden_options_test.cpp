// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/wooden/wooden_options.hpp"

#include <catch2/catch.hpp>

namespace wooden_options_test {

using namespace spm::servo;

TEST_CASE("Without options a WoodenHaptics of 2016 is held to 2 A and 5 N, and home is asked for") {
  const auto options = parse_wooden_options("");
  REQUIRE(options);
  REQUIRE(options->model->name == "woodenhaptics2016");
  REQUIRE_FALSE(options->protocol);
  REQUIRE(options->serial.empty());
  REQUIRE(options->current_limit == 2);
  REQUIRE(options->full_scale_current == 3);
  REQUIRE(options->force_cap == 5);
  REQUIRE_FALSE(options->gravity);
  REQUIRE(options->home_confirmed == WoodenHome::unconfirmed);
}

TEST_CASE("Every WoodenHaptics option is read with its unit") {
  const auto options = parse_wooden_options(
      "model=woody2019,protocol=v2,serial=A 7,signs=+-+,motor_signs=--+,home=-1:0:6000,"
      "home_confirmed=always,imax=6A,current_limit=2500mA,gravity=on,force_cap=3500mN");
  REQUIRE(options);
  REQUIRE(options->model->name == "woody2019");
  REQUIRE(options->protocol == WoodenProtocol::v2);
  REQUIRE(options->serial == "A 7");
  REQUIRE(options->home_confirmed == WoodenHome::always);
  REQUIRE(options->full_scale_current == 6);
  REQUIRE(options->current_limit == 2.5);
  REQUIRE(options->gravity);
  REQUIRE(options->force_cap == 3.5);
  const WoodenCalibration calibration = wooden_calibration(*options, WoodenProtocol::v2);
  REQUIRE(calibration.count_signs == std::array<double, 6>{1, -1, 1, 1, 1, 1});
  REQUIRE(calibration.motor_signs == std::array<double, 3>{-1, -1, 1});
  REQUIRE(calibration.home == std::array<double, 3>{-1, 0, 6000});
}

TEST_CASE("Six signs are those of all encoders") {
  const auto options = parse_wooden_options("signs=+-+-+-");
  REQUIRE(options);
  REQUIRE(wooden_calibration(*options, WoodenProtocol::v1).count_signs ==
          std::array<double, 6>{1, -1, 1, -1, 1, -1});
}

TEST_CASE("Without signs those of the protocol's public hosts are taken, with the model's home") {
  const auto options = parse_wooden_options("");
  REQUIRE(options);
  const WoodenCalibration first = wooden_calibration(*options, WoodenProtocol::v1);
  REQUIRE(signs_text(first.count_signs.data(), 3) == "+-+");
  REQUIRE(signs_text(first.motor_signs.data(), 3) == "-+-");
  for (const WoodenProtocol protocol : {WoodenProtocol::v2, WoodenProtocol::v3}) {
    const WoodenCalibration second = wooden_calibration(*options, protocol);
    REQUIRE(signs_text(second.count_signs.data(), 3) == "-+-");
    REQUIRE(signs_text(second.motor_signs.data(), 3) == "-+-");
    REQUIRE(second.home == std::array<double, 3>{0, 0, 6000});
  }
  for (const char* model : {"woodenhaptics2015", "woody2019", "aluhaptics", "vintage"}) {
    CAPTURE(model);
    const auto other = parse_wooden_options(std::string("model=") + model);
    REQUIRE(other);
    const WoodenCalibration third = wooden_calibration(*other, WoodenProtocol::v2);
    CHECK(signs_text(third.count_signs.data(), 3) == "+++");
    CHECK(signs_text(third.motor_signs.data(), 3) == "+++");
  }
}

TEST_CASE("No model's current turns a joint against its count, on any axis") {
  // The firmware of V1 counts backwards, that of V2 and V3 forwards.
  for (const auto& [protocol, forwards] :
       {std::pair(WoodenProtocol::v1, -1.0), std::pair(WoodenProtocol::v2, 1.0),
        std::pair(WoodenProtocol::v3, 1.0)}) {
    for (const WoodenModel& model : wooden_models) {
      for (const char* named : {"", ",signs=+++", ",signs=---", ",signs=-+-"}) {
        CAPTURE(to_string(protocol), model.name, named);
        const auto options = parse_wooden_options("model=" + std::string(model.name) + named);
        REQUIRE(options);
        const WoodenCalibration calibration = wooden_calibration(*options, protocol);
        for (std::size_t axis = 0; axis < 3; ++axis) {
          CHECK(calibration.count_signs[axis] * calibration.motor_signs[axis] == forwards);
        }
      }
    }
  }
}

TEST_CASE("At home the tool of each model is in front of its column, where public hosts have it") {
  for (const WoodenModel& model : wooden_models) {
    CAPTURE(model.name);
    WoodenCalibration calibration;
    calibration.home = model.home;
    const spm::Vector3 tool = wooden_position(model, wooden_angles(model, calibration, {0, 0, 0}));
    const bool woody = model.name.starts_with("wood");
    const spm::Vector3 home = woody                     ? spm::Vector3(0.025, 0, 0.205)
                              : model.name == "vintage" ? spm::Vector3(0, 0, -0.015)
                                                        : spm::Vector3(0, 0, 0);
    CHECK((tool - home).norm() < 1e-4);
  }
}

TEST_CASE("Signs are kept only where they are named") {
  REQUIRE(parse_wooden_options("signs=+++,keep_signs=on"));
  REQUIRE(parse_wooden_options("keep_signs=off"));
  const auto refused = parse_wooden_options("keep_signs=on");
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Catch::Contains("signs=-+-"));
}

TEST_CASE("The drives of 2015 may give 6 A, wherever the option stands") {
  REQUIRE(parse_wooden_options("model=woodenhaptics2015,current_limit=5A"));
  REQUIRE(parse_wooden_options("current_limit=5A,model=woodenhaptics2015"));
  REQUIRE_FALSE(parse_wooden_options("model=woodenhaptics2016,current_limit=5A"));
  REQUIRE(parse_wooden_options("current_limit=5A,imax=6A"));
}

TEST_CASE("A wrong WoodenHaptics option is a usage error that says what would do") {
  const auto [text, hint] = GENERATE(table<std::string, std::string>({
      {"colour=red", "model, protocol, serial, signs, motor_signs, keep_signs, home"},
      {"model=polhem", "woodenhaptics2015 woodenhaptics2016 woody2019 aluhaptics vintage"},
      {"model=", "woody2019"},
      {"protocol=v4", "auto, v1, v2 or v3"},
      {"serial=", "serial"},
      {"signs=+-", "encoders"},
      {"signs=+-+-", "encoders"},
      {"signs=+0+", "beside + and -"},
      {"motor_signs=+-+-+-", "motors"},
      {"home=0:0", "0:0:6000"},
      {"home=0:0:0:0", "0:0:6000"},
      {"home=0:0:", "0:0:6000"},
      {"home=0:0:6000.5", "0:0:6000"},
      {"home=0:0:40000", "0:0:6000"},
      {"home_confirmed=yes", "no, once or always"},
      {"imax=7A", "at most 6 A"},
      {"imax=0A", "out of range"},
      {"current_limit=2", "unit"},
      {"current_limit=2a", "unit"},
      {"current_limit=2A ", "unit"},
      {"current_limit=-1A", "out of range"},
      {"current_limit=nanA", "unit"},
      {"current_limit=4A", "imax"},
      {"gravity=yes", "on or off"},
      {"force_cap=6N", "5 N"},
      {"force_cap=0N", "above 0"},
      {"force_cap=5", "unit"},
      {"model", "option=value"},
  }));
  CAPTURE(text);
  const auto options = parse_wooden_options(text);
  REQUIRE_FALSE(options);
  REQUIRE(options.error().code == spm::ExitCode::usage);
  REQUIRE(options.error().message.find("woodenhaptics") != std::string::npos);
  REQUIRE(options.error().message.find(hint) != std::string::npos);
}

}  // namespace wooden_options_test
