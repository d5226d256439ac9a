// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/wooden/wooden_kinematics.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>

#include "common/base/random.hpp"

namespace wooden_kinematics_test {

using namespace spm;
using namespace spm::servo;

namespace {

constexpr double pi = std::numbers::pi;

/// Angles of a pose that the inverse gives back: elbow up, the tool in front of the column.
Vector3 random_angles(Random& random, const WoodenModel& model) {
  while (true) {
    const double upper = random.between(-1.2, 1.2);
    const double elbow = random.between(0.1, pi - 0.1);
    const Vector3 angles(random.between(-3, 3), upper, pi - upper - elbow);
    const double radius =
        model.length[1] * std::sin(angles[1]) + model.length[2] * std::sin(angles[2]);
    if (radius > 0.01) return angles;
  }
}

/// Slope of a function of three angles.
Vector3 slope(const std::function<double(const Vector3&)>& function, const Vector3& angles) {
  constexpr double step = 1e-6;
  Vector3 result;
  for (int i = 0; i < 3; ++i) {
    const Vector3 aside = step * Vector3::Unit(i);
    result[i] = (function(angles + aside) - function(angles - aside)) / (2 * step);
  }
  return result;
}

const WoodenModel& model_2016() { return *find_wooden_model("woodenhaptics2016"); }

WoodenCalibration calibration_of(const WoodenModel& model) {
  WoodenCalibration calibration;
  calibration.home = model.home;
  return calibration;
}

}  // namespace

TEST_CASE("With its counters at 0 a WoodenHaptics stands where its makers say") {
  for (const char* name : {"woodenhaptics2015", "woodenhaptics2016", "woody2019"}) {
    const WoodenModel& model = *find_wooden_model(name);
    const Vector3 angles = wooden_angles(model, calibration_of(model), {0, 0, 0});
    REQUIRE((angles - Vector3(0, 0, pi / 2)).norm() < 1e-12);
    const Vector3 position = wooden_position(model, angles);
    REQUIRE((position - Vector3(0.025, 0, 0.205)).norm() < 1e-12);
    REQUIRE((wooden_to_world * position - Vector3(0, 0.205, 0.025)).norm() < 1e-12);
  }
}

TEST_CASE("A vintage arm at home has its upper arm level and its lower arm hanging") {
  const WoodenModel& model = *find_wooden_model("vintage");
  const Vector3 angles = wooden_angles(model, calibration_of(model), {0, 0, 0});
  REQUIRE((angles - Vector3(0, pi / 2, 0)).norm() < 1e-12);
  REQUIRE((wooden_position(model, angles) - Vector3(0, 0, -0.112 + 0.097)).norm() < 1e-12);
}

TEST_CASE("One count moves the tool of a WoodenHaptics by 48, 54 and 64 um") {
  const WoodenModel& model = model_2016();
  const WoodenCalibration calibration = calibration_of(model);
  const Vector3 home = wooden_position(model, wooden_angles(model, calibration, {0, 0, 0}));
  const std::array<double, 3> steps{48e-6, 54e-6, 64e-6};
  for (std::size_t i = 0; i < 3; ++i) {
    std::array<std::int64_t, 3> counts{};
    counts[i] = 1;
    const Vector3 moved = wooden_position(model, wooden_angles(model, calibration, counts));
    REQUIRE((moved - home).norm() == Approx(steps[i]).margin(0.5e-6));
  }
}

TEST_CASE("The device's frame is turned to the world's, not mirrored") {
  REQUIRE((wooden_to_world * wooden_to_world.transpose()).isIdentity(1e-15));
  REQUIRE(wooden_to_world.determinant() == Approx(1));
  REQUIRE(wooden_to_world * Vector3::UnitZ() == Vector3::UnitY());
  REQUIRE(wooden_to_world * Vector3::UnitX() == Vector3::UnitZ());
}

TEST_CASE("Forward and inverse agree over many poses of every model") {
  for (const WoodenModel& model : wooden_models) {
    CAPTURE(std::string(model.name));
    Random random(11);
    for (int i = 0; i < 2000; ++i) {
      const Vector3 angles = random_angles(random, model);
      const auto found = wooden_inverse(model, wooden_position(model, angles));
      REQUIRE(found);
      REQUIRE((*found - angles).norm() < 1e-6);
      REQUIRE((wooden_position(model, *found) - wooden_position(model, angles)).norm() < 1e-9);
    }
  }
}

TEST_CASE("Out of reach there is no inverse") {
  for (const WoodenModel& model : wooden_models) {
    REQUIRE_FALSE(wooden_inverse(model, {1, 0, 0}));
    REQUIRE_FALSE(wooden_inverse(model, {0, 0, -5}));
    REQUIRE_FALSE(wooden_inverse(model, Vector3::Constant(std::nan(""))));
  }
}

TEST_CASE("Torques of a force are those of the position's numeric derivative") {
  for (const WoodenModel& model : wooden_models) {
    CAPTURE(std::string(model.name));
    Random random(12);
    for (int i = 0; i < 500; ++i) {
      const Vector3 angles = random_angles(random, model);
      const Vector3 force = random.between(0, 10) * random.direction();
      const Vector3 expected =
          slope([&](const Vector3& at) { return force.dot(wooden_position(model, at)); }, angles);
      REQUIRE((wooden_torques(model, angles, force) - expected).norm() < 1e-8);
    }
  }
}

/// Energy of the arm's height, J: the two masses alone.
double height_energy(const WoodenModel& model, const Vector3& angles) {
  constexpr double gravity = 9.80665;  // m/s^2
  const double upper_height = model.centre_of_mass[0] * std::cos(angles[1]);
  const double lower_height =
      model.length[1] * std::cos(angles[1]) - model.centre_of_mass[1] * std::cos(angles[2]);
  return gravity * (model.mass[0] * upper_height + model.mass[1] * lower_height);
}

TEST_CASE("The gravity term is the slope of the arm's energy") {
  for (const WoodenModel& model : wooden_models) {
    Random random(13);
    for (int i = 0; i < 500; ++i) {
      const Vector3 angles = random_angles(random, model);
      const Vector3 expected =
          slope([&](const Vector3& at) { return height_energy(model, at); }, angles);
      REQUIRE((wooden_gravity_torques(model, angles) - expected).norm() < 1e-8);
    }
  }
}

TEST_CASE("At 3 A a WoodenHaptics at home gives 5.07, 4.55 and 3.81 N") {
  const WoodenModel& model = model_2016();
  const WoodenCalibration calibration = calibration_of(model);
  const Vector3 angles = wooden_angles(model, calibration, {0, 0, 0});
  const std::array<double, 3> strongest{5.07, 4.55, 3.81};
  const std::array<Vector3, 3> ways{Vector3::UnitY(), Vector3::UnitX(), Vector3::UnitZ()};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto currents =
        wooden_currents(model, calibration, wooden_torques(model, angles, ways[i]), 6);
    REQUIRE(3000.0 / currents[i] == Approx(strongest[i]).margin(0.01));
    for (std::size_t j = 0; j < 3; ++j) REQUIRE((j == i || currents[j] == 0));
  }
}

TEST_CASE("Each sign turns one counter or one motor, and no other") {
  const WoodenModel& model = model_2016();
  WoodenCalibration turned = calibration_of(model);
  const WoodenCalibration plain = turned;
  for (std::size_t i = 0; i < 3; ++i) {
    turned = plain;
    turned.count_signs[i] = -1;
    turned.motor_signs[i] = -1;
    std::array<std::int64_t, 3> counts{100, 200, 300};
    const Vector3 expected = wooden_angles(model, plain, counts);
    const auto currents = wooden_currents(model, plain, {0.01, 0.02, 0.03}, 3);
    auto expected_currents = wooden_currents(model, turned, {0.01, 0.02, 0.03}, 3);
    counts[i] = -counts[i];
    expected_currents[i] = static_cast<std::int16_t>(-expected_currents[i]);
    REQUIRE(wooden_angles(model, turned, counts) == expected);
    REQUIRE(currents == expected_currents);
  }
}

TEST_CASE("Each motor's current is clipped alone") {
  const WoodenModel& model = model_2016();
  const auto currents = wooden_currents(model, calibration_of(model), {1000, -1000, 0.001}, 2);
  REQUIRE(currents[0] == 2000);
  REQUIRE(currents[1] == -2000);
  REQUIRE(currents[2] == 3);  // 1 mN m over 12 and 25.9 mN m/A
}

TEST_CASE("Without encoders in the handle the tool is never turned") {
  for (const WoodenModel& model : wooden_models) {
    if (model.gimbal_counts_per_turn > 0) continue;
    const auto turned =
        wooden_orientation(model, calibration_of(model), {0.3, 0.2, 1}, {100, 200, 300});
    REQUIRE(turned.isApprox(Eigen::Quaterniond::Identity()));
  }
}

TEST_CASE("With encoders in the handle the tool turns by what they count, at a level arm") {
  const WoodenModel& model = *find_wooden_model("vintage");
  const WoodenCalibration calibration = calibration_of(model);
  const Vector3 level(0, 0.4, pi / 2);
  REQUIRE(wooden_orientation(model, calibration, level, {0, 0, 0})
              .isApprox(Eigen::Quaterniond::Identity()));
  const Eigen::Quaterniond roll(Eigen::AngleAxisd(pi / 2, Vector3::UnitX()));
  REQUIRE(wooden_orientation(model, calibration, level, {500, 0, 0}).isApprox(roll));
  REQUIRE(wooden_orientation(model, calibration, level, {0, 0, 500}).isApprox(roll));
  const Eigen::Quaterniond pitch(Eigen::AngleAxisd(pi / 2, Vector3::UnitY()));
  REQUIRE(wooden_orientation(model, calibration, level, {0, 500, 0}).isApprox(pitch));
  const Eigen::Quaterniond yaw(Eigen::AngleAxisd(0.5, Vector3::UnitZ()));
  REQUIRE(wooden_orientation(model, calibration, {0.5, 0.4, pi / 2}, {0, 0, 0}).isApprox(yaw));
}

}  // namespace wooden_kinematics_test
