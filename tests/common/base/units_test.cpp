// SPDX-License-Identifier: Apache-2.0
#include "common/base/units.hpp"

#include <catch2/catch.hpp>
#include <numbers>
#include <random>

namespace units_test {

using spm::format_quantity;
using spm::parse_mesh_unit;
using spm::parse_probe;
using spm::parse_quantity;
using spm::Quantity;

TEST_CASE("A length is read in metres, to the last bit that its decimal text has") {
  CHECK(parse_quantity("50um", Quantity::length).value() == 50e-6);
  CHECK(parse_quantity("2mm", Quantity::length).value() == 2e-3);
  CHECK(parse_quantity("1.5cm", Quantity::length).value() == 0.015);
  CHECK(parse_quantity("-3m", Quantity::length).value() == -3.0);
  CHECK(parse_quantity("1e2um", Quantity::length).value() == 1e-4);
  CHECK(parse_quantity("1in", Quantity::length).value() == 0.0254);
}

TEST_CASE("Blanks around the number and its unit do not matter") {
  CHECK(parse_quantity(" 50 um ", Quantity::length).value() == 50e-6);
}

TEST_CASE("The micro sign and the Greek mu stand for u wherever um is read") {
  CHECK(parse_quantity("50\u00B5m", Quantity::length).value() == 50e-6);
  CHECK(parse_quantity("50 \u03BCm", Quantity::length).value() == 50e-6);
  CHECK(parse_probe("sphere:500\u00B5m").value() == 500e-6);
  CHECK_FALSE(parse_quantity("50\u00B5", Quantity::length));
  CHECK_FALSE(parse_quantity("50\xB5m", Quantity::length));
}

TEST_CASE("A rate is read in hertz") {
  CHECK(parse_quantity("1000Hz", Quantity::rate).value() == 1000);
  CHECK(parse_quantity("1kHz", Quantity::rate).value() == 1000);
  CHECK_FALSE(parse_quantity("1khz", Quantity::rate));
}

TEST_CASE("Every quantity has its own units") {
  CHECK(parse_quantity("1.5N/mm", Quantity::stiffness).value() == 1500.0);
  CHECK(parse_quantity("800N/m", Quantity::stiffness).value() == 800.0);
  CHECK(parse_quantity("500mN", Quantity::force).value() == 0.5);
  CHECK(parse_quantity("50mm/s", Quantity::speed).value() == 0.05);
  CHECK(parse_quantity("180deg", Quantity::angle).value() == Approx(std::numbers::pi));
  CHECK(parse_quantity("0.2rad", Quantity::angle).value() == 0.2);
  CHECK(parse_quantity("2Ns/m", Quantity::damping).value() == 2.0);
  CHECK(parse_quantity("120rad/s", Quantity::angular_speed).value() == 120.0);
  CHECK(parse_quantity("180deg/s", Quantity::angular_speed).value() == Approx(3.14159265));
  CHECK(parse_quantity("1N s/m", Quantity::damping).value() == 1.0);
  CHECK(parse_quantity("100/m", Quantity::per_length).value() == 100.0);
  CHECK(parse_quantity("0.1/mm", Quantity::per_length).value() == 100.0);
  CHECK(parse_quantity("150g", Quantity::mass).value() == 0.15);
  CHECK(parse_quantity("100mNm", Quantity::torque).value() == 0.1);
  CHECK(parse_quantity("0.1N m", Quantity::torque).value() == 0.1);
  CHECK(parse_quantity("0.5Nm", Quantity::torque).value() == 0.5);
  CHECK(parse_quantity("500 mN m/rad", Quantity::turning_stiffness).value() == 0.5);
  CHECK(parse_quantity("2Nm/rad", Quantity::turning_stiffness).value() == 2.0);
  CHECK(parse_quantity("400us", Quantity::duration).value() == 400e-6);
  CHECK(parse_quantity("1ms", Quantity::duration).value() == 1e-3);
  CHECK(parse_quantity("2min", Quantity::duration).value() == 120);
  CHECK(format_quantity(0.1, Quantity::torque) == "100 mN m");
  CHECK_FALSE(parse_quantity("1N/mm", Quantity::torque));
  CHECK_FALSE(parse_quantity("1N/mm", Quantity::length));
  CHECK_FALSE(parse_quantity("1mm", Quantity::force));
}

TEST_CASE("A bare number is a usage error that shows how to write it") {
  const auto result = parse_quantity("50", Quantity::length);
  REQUIRE_FALSE(result);
  CHECK(result.error().code == spm::ExitCode::usage);
  CHECK(result.error().message == "'50' has no unit: write a length such as 50um or 2mm");
}

TEST_CASE("Text that is no finite quantity is a usage error") {
  for (const char* text : {"", "  ", "mm", "um50", "nanmm", "infm", "1e999m", "1..5mm", "1mm2",
                           "1,5mm", "0x10mm", "1e308mm mm", "5 parsec", "5MM", "+5mm"}) {
    INFO(text);
    const auto result = parse_quantity(text, Quantity::length);
    REQUIRE_FALSE(result);
    CHECK(result.error().code == spm::ExitCode::usage);
    CHECK_FALSE(result.error().message.empty());
  }
}

TEST_CASE("A printed quantity reads well and parses back within its four digits") {
  CHECK(format_quantity(50e-6, Quantity::length) == "50 um");
  CHECK(format_quantity(2e-3, Quantity::length) == "2 mm");
  CHECK(format_quantity(1e-3, Quantity::length) == "1 mm");
  CHECK(format_quantity(0.1, Quantity::length) == "100 mm");
  CHECK(format_quantity(0, Quantity::length) == "0 um");
  CHECK(format_quantity(1000, Quantity::stiffness) == "1 N/mm");
  std::mt19937_64 random(1);
  for (int i = 0; i < 1000; ++i) {
    const double exponent = static_cast<double>(random() % 1000) / 100.0 - 7.0;
    const double value = std::pow(10.0, exponent);
    const std::string text = format_quantity(value, Quantity::length);
    INFO(text);
    CHECK(parse_quantity(text, Quantity::length).value() == Approx(value).epsilon(1e-3));
  }
}

TEST_CASE("A probe is a point or a sphere with a radius above zero") {
  CHECK(parse_probe("point").value() == 0.0);
  CHECK(parse_probe("sphere:0.5mm").value() == 0.5e-3);
  for (const char* text :
       {"", "Point", "sphere", "sphere:", "sphere:1", "sphere:0mm", "sphere:-1mm", "cube:1mm"}) {
    INFO(text);
    CHECK_FALSE(parse_probe(text));
  }
}

TEST_CASE("A mesh file's unit is one of four") {
  CHECK(parse_mesh_unit("m").value() == 1.0);
  CHECK(parse_mesh_unit("mm").value() == 0.001);
  CHECK(parse_mesh_unit("cm").value() == 0.01);
  CHECK(parse_mesh_unit("in").value() == 0.0254);
  CHECK_FALSE(parse_mesh_unit("MM"));
  CHECK_FALSE(parse_mesh_unit("1mm"));
}

}  // namespace units_test
