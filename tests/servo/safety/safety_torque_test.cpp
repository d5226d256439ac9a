// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "common/base/random.hpp"
#include "common/base/turn_between.hpp"
#include "servo/safety/safety.hpp"

namespace safety_torque_test {

using namespace spm::servo;
using spm::HandPose;
using spm::Random;
using spm::turn_between;
using spm::Vector3;
using spm::Wrench;

namespace {

constexpr SafetySettings settings{8.0, 2.0, 1e-3, 0.5, 0.02};
constexpr double pi = 3.14159265358979323846;

SafetyStage engaged() {
  SafetyStage stage(settings);
  for (int i = 0; i < 200; ++i) static_cast<void>(stage.apply({}, ForceOff::none));
  return stage;
}

Wrench turning(double about_z) { return {Vector3::Zero(), {0, 0, about_z}}; }

HandPose turned(double angle, const Vector3& axis = Vector3::UnitY()) {
  return {Vector3::Zero(), Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis))};
}

}  // namespace

TEST_CASE("A torque that is not a number makes force and torque zero, with the cause") {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    SafetyStage stage = engaged();
    const SafeWrench sent = stage.apply({{1, 0, 0}, {0, bad, 0}}, ForceOff::none);
    CHECK(sent.force == Vector3::Zero());
    CHECK(sent.torque == Vector3::Zero());
    CHECK(sent.cause == ForceOff::not_a_number);
  }
}

TEST_CASE("Every cause makes the torque zero too") {
  for (std::size_t i = 1; i < force_off_count; ++i) {
    SafetyStage stage = engaged();
    const SafeWrench sent = stage.apply({{1, 2, 3}, {0.1, 0, 0}}, static_cast<ForceOff>(i));
    CHECK(sent.torque == Vector3::Zero());
  }
}

TEST_CASE(
    "A torque is held to its cap and keeps its direction, and that does not touch the force") {
  SafetyStage stage = engaged();
  const Wrench wanted{{1, 0, 0}, {3, -4, 0}};
  SafeWrench sent;
  for (int i = 0; i < 100; ++i) sent = stage.apply(wanted, ForceOff::none);
  CHECK(sent.torque_capped);
  CHECK_FALSE(sent.capped);
  CHECK(sent.torque.norm() == Approx(0.5));
  CHECK(sent.torque.normalized().dot(wanted.torque.normalized()) == Approx(1.0));
  CHECK(sent.force == wanted.force);
}

TEST_CASE("A force at its cap leaves the torque as it is wanted") {
  SafetyStage stage = engaged();
  SafeWrench sent;
  for (int i = 0; i < 100; ++i) {
    sent = stage.apply({{0, 0, 80}, {0.1, 0.2, 0}}, ForceOff::none);
  }
  CHECK(sent.capped);
  CHECK_FALSE(sent.torque_capped);
  CHECK(sent.torque == Vector3(0.1, 0.2, 0));
}

TEST_CASE("No torque beyond the cap is ever sent, whatever is wanted") {
  Random random(5);
  SafetyStage stage(settings);
  for (int i = 0; i < 20'000; ++i) {
    const Wrench wanted{random.direction() * random.between(0, 100),
                        random.direction() * random.between(0, 10)};
    const auto cause = random.next() % 50 == 0 ? ForceOff::asset_lost : ForceOff::none;
    const SafeWrench sent = stage.apply(wanted, cause);
    REQUIRE(sent.torque.norm() <= 0.5 * (1 + 1e-12));
    REQUIRE(sent.force.norm() <= 8.0 * (1 + 1e-12));
  }
}

TEST_CASE("To a device without torque none is sent") {
  SafetyStage stage(safety_settings(8, 1000, 1000));
  for (int i = 0; i < 200; ++i) {
    REQUIRE(stage.apply({{1, 0, 0}, {0, 0, 0.1}}, ForceOff::none).torque == Vector3::Zero());
  }
}

TEST_CASE("The torque fades in with the force") {
  SafetyStage stage(settings);
  const Wrench wanted{{1, 0, 0}, {0, 0, 0.15}};
  for (int i = 1; i <= 150; ++i) {
    const SafeWrench sent = stage.apply(wanted, ForceOff::none);
    REQUIRE(sent.torque.z() == Approx(i * 1e-3));
    REQUIRE(sent.force.x() == Approx(i / 150.0));
  }
}

TEST_CASE("A sudden torque grows no faster than its slew limit, and ends at once") {
  SafetyStage stage = engaged();
  const SafeWrench first = stage.apply(turning(0.4), ForceOff::none);
  CHECK(first.torque_slewed);
  CHECK_FALSE(first.slewed);
  CHECK(first.torque.norm() == Approx(0.02));
  for (int i = 0; i < 5; ++i) static_cast<void>(stage.apply(turning(0.4), ForceOff::none));
  CHECK(stage.apply(turning(0), ForceOff::none).torque == Vector3::Zero());
}

TEST_CASE("A torque that turns round passes through smaller ones") {
  SafetyStage stage = engaged();
  for (int i = 0; i < 30; ++i) static_cast<void>(stage.apply(turning(0.3), ForceOff::none));
  Vector3 last(0, 0, 0.3);
  for (int i = 0; i < 40; ++i) {
    const Vector3 sent = stage.apply(turning(-0.3), ForceOff::none).torque;
    REQUIRE((sent - last).norm() <= 0.02 + 1e-12);
    REQUIRE(sent.norm() <= 0.3 + 1e-12);
    last = sent;
  }
  CHECK(last.z() == Approx(-0.3));
}

TEST_CASE("A torque that ends in a soft start ends at once, while the force goes on") {
  SafetyStage stage(settings);
  const Wrench both{{2, 0, 0}, {0, 0, 0.2}};
  for (int i = 0; i < 10; ++i) static_cast<void>(stage.apply(both, ForceOff::none));
  const SafeWrench sent = stage.apply({{2, 0, 0}, Vector3::Zero()}, ForceOff::none);
  CHECK(sent.torque == Vector3::Zero());
  CHECK(sent.force.x() == Approx(2 * 11 / 150.));
}

TEST_CASE("What is not trusted for long fades in its torque as in its force") {
  SafetyStage stage = engaged();
  const Wrench wanted{{1, 0, 0}, {0, 0, 0.1}};
  for (int i = 0; i < 10; ++i) static_cast<void>(stage.apply(wanted, ForceOff::none));
  for (int i = 1; i < 500; ++i) {
    const SafeWrench sent = stage.apply(wanted, ForceOff::none, Fade::silent);
    REQUIRE(sent.torque.z() == Approx(0.1 * (1 - i / 500.0)));
  }
  static_cast<void>(stage.apply(wanted, ForceOff::none, Fade::silent));
  CHECK(stage.apply(wanted, ForceOff::none, Fade::silent).torque == Vector3::Zero());
}

TEST_CASE("A torque may grow as far as a force at the tool's farthest place turns the hand") {
  CHECK(torque_slew_limit(3, 0.2) == Approx(0.6));
  CHECK(torque_slew_limit(3, 0) == Approx(3 * shortest_arm));
}

TEST_CASE("A turn that no hand makes in a tick is a jump, and the next is compared with it") {
  JumpGate gate(1000);
  CHECK_FALSE(gate.jumped(turned(0), 0));
  CHECK_FALSE(gate.jumped(turned(0.049), 1));
  CHECK(gate.jumped(turned(0.101), 2));
  CHECK_FALSE(gate.jumped(turned(0.102), 3));
  CHECK(gate.jumped(turned(0.102 + pi), 4));
}

TEST_CASE("A quaternion and its negative are the same orientation") {
  JumpGate gate(1000);
  HandPose pose = turned(0.3, Vector3(1, 2, 3).normalized());
  CHECK_FALSE(gate.jumped(pose, 0));
  pose.orientation.coeffs() = -pose.orientation.coeffs();
  CHECK_FALSE(gate.jumped(pose, 1));
  CHECK(turn_between(turned(0.3).orientation, pose.orientation).norm() < pi + 1e-12);
}

TEST_CASE("Ticks that were skipped leave a hand the more to turn") {
  JumpGate gate(1000);
  CHECK_FALSE(gate.jumped(turned(0), 7));
  CHECK_FALSE(gate.jumped(turned(0.14), 10));
  CHECK(gate.jumped(turned(0.3), 13));
  gate.forget();
  CHECK_FALSE(gate.jumped(turned(2), 14));
}

TEST_CASE("A turn is told along its axis, the shorter way round") {
  const Vector3 axis = Vector3(1, -2, 2) / 3;
  const auto from = turned(1.1, axis).orientation;
  CHECK((turn_between(from, turned(1.4, axis).orientation) - 0.3 * axis).norm() < 1e-12);
  CHECK((turn_between(from, turned(1.1 + 2 * pi - 0.2, axis).orientation) + 0.2 * axis).norm() <
        1e-12);
  CHECK(turn_between(from, from).norm() < 1e-15);
}

TEST_CASE("A pose is finite, and its orientation is of unit length") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(is_pose(turned(2)));
  HandPose pose;
  pose.orientation.coeffs() *= 1 + 1e-5;
  CHECK_FALSE(is_pose(pose));
  pose.orientation.coeffs().setZero();
  CHECK_FALSE(is_pose(pose));
  pose.orientation = Eigen::Quaterniond(nan, 0, 0, 1);
  CHECK_FALSE(is_pose(pose));
  CHECK_FALSE(is_pose({{0, nan, 0}, Eigen::Quaterniond::Identity()}));
}

}  // namespace safety_torque_test
