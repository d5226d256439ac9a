// SPDX-License-Identifier: Apache-2.0
// What the loop keeps for a device: clutch, motion, and the account of work.
#include "servo/loop/channel.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "common/base/turn_between.hpp"

namespace channel_test {

using namespace spm;
using namespace spm::servo;

namespace {

Eigen::Quaterniond turned(double angle, const Vector3& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
}

HandPose pose_at(const Vector3& position, double angle = 0,
                 const Vector3& axis = Vector3::UnitZ()) {
  return {position, turned(angle, axis)};
}

}  // namespace

TEST_CASE("Without a clutch the tool is where the hand is, to the last bit") {
  Clutch clutch;
  const HandPose hand = pose_at({0.1, 1.0 / 3, -2e-3}, 1.234, Vector3(1, 2, 3).normalized());
  const HandPose tool = clutch.tool_of(hand, false);
  CHECK(tool.position == hand.position);
  CHECK(tool.orientation.coeffs() == hand.orientation.coeffs());
}

TEST_CASE("While the clutch is held the tool stays in place and in turn, and then follows") {
  Clutch clutch;
  const HandPose before = clutch.tool_of(pose_at({0.01, 0.02, 0}, 0.4), false);
  for (int i = 1; i <= 100; ++i) {
    const HandPose free = pose_at({0.01, 0.02 + 1e-4 * i, 0}, 0.4 + 0.01 * i, Vector3::UnitX());
    const HandPose tool = clutch.tool_of(free, true);
    REQUIRE(tool.position == before.position);
    REQUIRE(tool.orientation.coeffs() == before.orientation.coeffs());
  }
  const HandPose there = pose_at({0.01, 0.03, 0}, 1.4, Vector3::UnitX());
  HandPose tool = clutch.tool_of(there, false);
  CHECK((tool.position - before.position).norm() < 1e-15);
  CHECK(turn_between(before.orientation, tool.orientation).norm() < 1e-14);
  // Then each way and each turn of the hand is the tool's, in the same direction.
  const Vector3 way(1e-3, -2e-3, 3e-3), turn = 0.2 * Vector3(2, -1, 2).normalized();
  const HandPose moved{there.position + way, turned(0.2, turn.normalized()) * there.orientation};
  tool = clutch.tool_of(moved, false);
  CHECK((tool.position - before.position - way).norm() < 1e-15);
  CHECK((turn_between(before.orientation, tool.orientation) - turn).norm() < 1e-14);
}

TEST_CASE("A hand that turns evenly has that angular velocity, about its axis") {
  const Vector3 axis = Vector3(1, 2, -2) / 3;
  HandVelocity motion(1e-6, 1e-5, 1e-3);
  for (int i = 0; i < 2000; ++i) motion.take(pose_at({1e-5 * i, 0, 0}, 3e-3 * i, axis), 1);
  CHECK((motion.angular_velocity() - 3 * axis).norm() < 0.02);
  CHECK(motion.velocity().x() == Approx(0.01).epsilon(0.01));
  motion.reset();
  CHECK(motion.angular_velocity() == Vector3::Zero());
  motion.take(pose_at(Vector3::Zero(), 3, axis), 1);
  CHECK(motion.angular_velocity() == Vector3::Zero());
}

TEST_CASE("A quaternion that changes its sign is no turn") {
  HandVelocity motion(1e-6, 1e-5, 1e-3);
  HandPose pose = pose_at(Vector3::Zero(), 0.7);
  for (int i = 0; i < 100; ++i) {
    pose.orientation.coeffs() = -pose.orientation.coeffs();
    motion.take(pose, 1);
  }
  CHECK(motion.angular_velocity().norm() < 1e-9);
}

TEST_CASE("The work of a torque is that of a spring that turns back: what went in comes out") {
  // N m/rad; the torque of each tick acts until the next.
  constexpr double spring = 0.5;
  const Vector3 axis = Vector3(2, 3, 6) / 7;
  WorkAccount account;
  double work = 0;
  constexpr int ticks = 1000;
  for (int i = 0; i <= ticks; ++i) {
    const double angle = 0.8 * i / ticks;
    work += account.next(pose_at(Vector3::Zero(), angle, axis), {{}, -spring * angle * axis});
  }
  CHECK(work == Approx(-0.5 * spring * 0.64).epsilon(2e-3));
  for (int i = ticks; i >= 0; --i) {
    const double angle = 0.8 * i / ticks;
    work += account.next(pose_at(Vector3::Zero(), angle, axis), {{}, -spring * angle * axis});
  }
  // Held for a tick too long on each way: what sampling gives.
  CHECK(work == Approx(spring * 0.8 * 0.8 / ticks).epsilon(0.01));
}

TEST_CASE("Force and torque do their work each along its own motion") {
  WorkAccount account;
  CHECK(account.next(pose_at({0, 0, 0}), {{1, 2, 0}, {0, 0, 0.1}}) == 0);
  const double work = account.next(pose_at({0.01, 0.02, 0}, 0.3), {});
  CHECK(work == Approx(0.01 + 2 * 0.02 + 0.1 * 0.3));
  CHECK(account.next(pose_at({0.5, 0.02, 0}, 0.9), {}) == 0);
}

}  // namespace channel_test
