// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/falcon/falcon_kinematics.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <utility>

#include "common/base/random.hpp"
#include "servo/devices/falcon/falcon_packet.hpp"
#include "tests/servo/devices/falcon/falcon_counts.hpp"

namespace falcon_kinematics_test {

using namespace spm;
using namespace spm::servo;
using spm::test::falcon_counts;

namespace {

/// A position in the largest cube that the legs reach every corner of, nearly.
Vector3 position_in_workspace(Random& random) {
  return {random.between(-0.045, 0.045), random.between(-0.045, 0.045),
          random.between(-0.045, 0.045)};
}

constexpr double degree = std::numbers::pi / 180;

}  // namespace

TEST_CASE("On the device's axis the three thighs turn alike, as published and checked") {
  const auto [distance, degrees, counts] = GENERATE(table<double, double, double>({
      {0.08, -11.80, -1284},
      {0.10, 8.01, -741},
      {0.11, 16.19, -516},
      {0.12, 23.92, -304},
      {0.13, 31.49, -96},
      {0.14, 39.17, 115},
      {0.15, 47.24, 336},
      {0.16, 56.14, 580},
      {0.17, 66.76, 872},
  }));
  CAPTURE(distance);
  const auto angles = falcon_inverse({0, 0, distance - falcon_centre_distance});
  REQUIRE(angles);
  for (Eigen::Index i = 0; i < 3; ++i) {
    REQUIRE((*angles)[i] == Approx(degrees * degree).margin(0.006 * degree));
    REQUIRE(falcon_counts(*angles)[i] == Approx(counts).margin(0.6));
  }
}

TEST_CASE("A count is 0.0364346591 degrees of a thigh, and zero is 35 degrees") {
  const Vector3 angles = falcon_angles({0, 1000, -1000});
  REQUIRE(angles[0] == Approx(35 * degree));
  REQUIRE(angles[1] == Approx((35 + 36.4346591) * degree).margin(1e-9));
  REQUIRE(angles[2] == Approx((35 - 36.4346591) * degree).margin(1e-9));
  REQUIRE(falcon_angles({0, 0, 0}, 0.6)[2] == 0.6);
  REQUIRE(falcon_counts(angles).isApprox(Vector3(0, 1000, -1000), 1e-9));
}

TEST_CASE("What the angles of a position say is that position, from a start nearby") {
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const Vector3 position = position_in_workspace(random);
    const auto angles = falcon_inverse(position);
    REQUIRE(angles);
    const Vector3 nearby =
        position + Vector3(random.between(-2e-3, 2e-3), random.between(-2e-3, 2e-3),
                           random.between(-2e-3, 2e-3));
    const FalconPose pose = falcon_forward(*angles, nearby);
    REQUIRE(pose.search == FalconSearch::found);
    REQUIRE((pose.position - position).norm() < 1e-9);
    REQUIRE(pose.steps <= 8);
  }
}

TEST_CASE("Every position of the workspace is found from the device's centre too") {
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const Vector3 position = position_in_workspace(random);
    const auto angles = falcon_inverse(position);
    REQUIRE(angles);
    const FalconPose pose = falcon_forward(*angles, Vector3::Zero());
    REQUIRE(pose.search == FalconSearch::found);
    REQUIRE((pose.position - position).norm() < 1e-9);
    REQUIRE(pose.steps <= 10);
  }
}

TEST_CASE("A hand is followed along a path through the workspace without a jump") {
  Vector3 position = Vector3::Zero();
  for (int i = 0; i < 20000; ++i) {
    const double t = i * 1e-3;
    const Vector3 true_position(0.04 * std::sin(3.1 * t), 0.04 * std::sin(2.3 * t),
                                0.04 * std::sin(1.7 * t));
    const auto angles = falcon_inverse(true_position);
    REQUIRE(angles);
    const FalconPose pose = falcon_forward(*angles, position);
    REQUIRE(pose.search == FalconSearch::found);
    REQUIRE((pose.position - true_position).norm() < 1e-9);
    REQUIRE(pose.steps <= 5);
    position = pose.position;
  }
}

TEST_CASE("Angles of no position, or that are no numbers, are not found in bounded steps") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Vector3& angles : {Vector3(nan, 0.4, 0.4), Vector3(3, -1, 0.4), Vector3(-2, 2, 2)}) {
    const FalconPose pose = falcon_forward(angles, Vector3::Zero());
    REQUIRE(pose.search != FalconSearch::found);
    REQUIRE(pose.steps <= falcon_max_steps);
  }
  REQUIRE(falcon_forward(Vector3::Constant(0.4), Vector3(nan, 0, 0)).search ==
          FalconSearch::not_found);
}

TEST_CASE("Any counts end in bounded steps, with a finite position where one is found") {
  for (std::uint64_t seed = 1; seed <= 5000; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    std::array<std::int16_t, 3> counts{};
    for (auto& count : counts) count = static_cast<std::int16_t>(random.next());
    const FalconPose pose = falcon_forward(falcon_angles(counts), Vector3::Zero());
    REQUIRE(pose.steps <= falcon_max_steps);
    if (pose.search == FalconSearch::found) REQUIRE(pose.position.allFinite());
  }
}

TEST_CASE("What the legs do not reach has no angles") {
  REQUIRE_FALSE(falcon_inverse({0.3, 0, 0}));
  REQUIRE_FALSE(falcon_inverse({0, 0, 0.2}));
  REQUIRE_FALSE(falcon_inverse({std::numeric_limits<double>::quiet_NaN(), 0, 0}));
}

TEST_CASE("The Jacobian is the derivative of the thighs' angles") {
  constexpr double h = 1e-6;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const Vector3 position = position_in_workspace(random);
    const auto angles = falcon_inverse(position);
    REQUIRE(angles);
    const Eigen::Matrix3d jacobian = falcon_jacobian(position, *angles);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const Vector3 step = h * Vector3::Unit(axis);
      const auto after = falcon_inverse(position + step), before = falcon_inverse(position - step);
      REQUIRE((after && before));
      const Vector3 numeric = (*after - *before) / (2 * h);
      const Vector3 column = jacobian.col(axis);
      REQUIRE((column - numeric).norm() < 1e-6 * (1 + numeric.norm()));
    }
  }
}

TEST_CASE("The thighs' power is the hand's power") {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const Vector3 position = position_in_workspace(random);
    const auto angles = falcon_inverse(position);
    REQUIRE(angles);
    const Vector3 force(random.between(-5, 5), random.between(-5, 5), random.between(-5, 5));
    const Vector3 velocity(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
    const auto torques = falcon_torques(position, *angles, force);
    REQUIRE(torques);
    const Vector3 turning = falcon_jacobian(position, *angles) * velocity;
    REQUIRE(torques->dot(turning) == Approx(force.dot(velocity)).margin(1e-9));
  }
}

TEST_CASE("At the centre a newton takes the commands that were worked out before") {
  const auto angles = falcon_inverse(Vector3::Zero());
  REQUIRE(angles);
  const auto motors = [&angles](const Vector3& force) {
    const auto torques = falcon_torques(Vector3::Zero(), *angles, force);
    REQUIRE(torques);
    return falcon_motors(*torques);
  };
  const auto outward = motors({0, 0, 1});
  for (const int motor : outward) REQUIRE(motor == Approx(-250).margin(2));
  const auto right = motors({1, 0, 0});
  REQUIRE(right[0] == Approx(-171).margin(1));
  REQUIRE(right[1] == Approx(580).margin(1));
  REQUIRE(right[2] == Approx(-409).margin(1));
}

TEST_CASE("One motor at its limit slows all three, so that the force keeps its direction") {
  const auto angles = falcon_inverse({0.01, -0.02, 0.01});
  REQUIRE(angles);
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const Vector3 force(random.between(-50, 50), random.between(-50, 50), random.between(-50, 50));
    const auto torques = falcon_torques({0.01, -0.02, 0.01}, *angles, force);
    REQUIRE(torques);
    const auto motors = falcon_motors(*torques);
    const Vector3 sent(motors[0], motors[1], motors[2]);
    REQUIRE(sent.cwiseAbs().maxCoeff() <= falcon_motor_limit);
    const Vector3 wanted = -10000 * *torques;
    if (wanted.norm() < 100) continue;
    REQUIRE(sent.normalized().dot(wanted.normalized()) > 1 - 1e-4);
    if (wanted.cwiseAbs().maxCoeff() > falcon_motor_limit) {
      REQUIRE(sent.cwiseAbs().maxCoeff() == falcon_motor_limit);
    }
  }
}

TEST_CASE("Torques that are no numbers, and legs stretched out, give no command") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::array<std::int16_t, 3> zero{};
  REQUIRE(falcon_motors({nan, 0, 0}) == zero);
  REQUIRE(falcon_motors({0, std::numeric_limits<double>::infinity(), 0}) == zero);
  const auto angles = falcon_inverse(Vector3::Zero());
  REQUIRE(angles);
  REQUIRE_FALSE(falcon_torques(Vector3::Zero(), *angles, {nan, 0, 0}));
  REQUIRE_FALSE(falcon_torques({0.3, 0, 0}, *angles, {1, 0, 0}));
}

}  // namespace falcon_kinematics_test
