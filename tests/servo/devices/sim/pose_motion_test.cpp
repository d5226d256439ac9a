// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/pose_motion.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "common/base/random.hpp"

namespace pose_motion_test {

using namespace spm;
using namespace spm::servo;

namespace {

constexpr double period = 1e-3;

HandPose pose(double x, double angle) {
  return {Vector3(x, 0, 0), orientation_of(Vector3(0, 0, angle))};
}

std::vector<HandPose> random_points(std::uint64_t seed, std::size_t count) {
  Random random(seed);
  std::vector<HandPose> points;
  for (std::size_t i = 0; i < count; ++i) points.push_back(unturned(0.001 * random.direction()));
  return points;
}

double angle_of(const SixdofTarget& target) {
  return turn_between(Eigen::Quaterniond::Identity(), target.orientation).z();
}

}  // namespace

TEST_CASE("A way takes as long as the slower of moving and turning, and both arrive together") {
  PoseMotion motion = PoseMotion::press({pose(0, 0), pose(0.01, 0.5)}, {0.1, 1}, period);
  SixdofTarget target;
  for (int tick = 0; tick < 250; ++tick) target = motion.next();
  CHECK(target.position.x() == Approx(0.005));
  CHECK(angle_of(target) == Approx(0.25));
  CHECK(target.velocity.x() == Approx(0.02));
  CHECK(target.angular_velocity.z() == Approx(1));
  for (int tick = 0; tick < 300; ++tick) target = motion.next();
  CHECK(target.position.x() == 0.01);
  CHECK(angle_of(target) == Approx(0.5));
  CHECK(target.velocity.isZero());
  CHECK(target.angular_velocity.isZero());
}

TEST_CASE("A motion back and forth returns to where it turns, again and again, without a jump") {
  PoseMotion motion = PoseMotion::back_and_forth({pose(-0.01, 0), pose(0, 0.1), pose(0.02, -0.1)},
                                                 1, {0.1, 10}, period);
  double least = 1, most = -1;
  Vector3 before = motion.start().position;
  for (int tick = 0; tick < 2000; ++tick) {
    const SixdofTarget target = motion.next();
    REQUIRE((target.position - before).norm() <= 0.1 * period * (1 + 1e-9));
    before = target.position;
    if (tick < 200) continue;
    least = std::min(least, target.position.x());
    most = std::max(most, target.position.x());
  }
  CHECK(least == Approx(0).margin(1e-4));
  CHECK(most == Approx(0.02).margin(1e-4));
  CHECK(motion.cycle_ticks() == Approx(600).margin(20));
}

TEST_CASE("A recorded hand follows a pose a tick, and a jump becomes a fast way and a fast turn") {
  PoseMotion motion = PoseMotion::recorded({pose(0, 0), pose(1e-4, 1e-3), pose(1e-4, 2.0)}, period);
  static_cast<void>(motion.next());
  SixdofTarget target = motion.next();
  CHECK(target.position.x() == Approx(1e-4));
  CHECK(angle_of(target) == Approx(1e-3));
  target = motion.next();
  CHECK(target.angular_velocity.norm() == Approx(fastest_turn));
  for (int tick = 0; tick < 200; ++tick) target = motion.next();
  CHECK(angle_of(target) == Approx(2.0));
}

TEST_CASE("Poses that all coincide end nothing") {
  PoseMotion motion =
      PoseMotion::back_and_forth({pose(0, 1), pose(0, 1), pose(0, 1)}, 1, {}, period);
  for (int tick = 0; tick < 10; ++tick) REQUIRE(angle_of(motion.next()) == Approx(1));
}

TEST_CASE("A hand that does not turn moves at its speed, never faster, and never turns") {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    auto motion =
        PoseMotion::back_and_forth(random_points(seed, 8), 1, {0.04, fastest_turn}, period);
    Vector3 last = motion.start().position;
    for (int i = 0; i < 3000; ++i) {
      const SixdofTarget target = motion.next();
      REQUIRE((target.position - last).norm() <= 0.04 * period * (1 + 1e-9));
      REQUIRE((target.velocity * period - (target.position - last)).norm() < 1e-12);
      REQUIRE(target.orientation.coeffs() == Eigen::Quaterniond::Identity().coeffs());
      last = target.position;
    }
  }
}

TEST_CASE("A sweep comes to every point and comes back") {
  const std::vector<HandPose> points{unturned({0, 0, 1e-3}), unturned({0, 0, 0}),
                                     unturned({1e-3, 0, 0})};
  auto motion = PoseMotion::back_and_forth(points, 1, {0.1, fastest_turn}, period);
  int arrivals_far = 0;
  int returns = 0;
  for (int i = 0; i < 200; ++i) {
    const Vector3 at = motion.next().position;
    arrivals_far += at.isApprox(points[2].position, 1e-9) ? 1 : 0;
    returns += at.norm() < 1e-12 ? 1 : 0;
    REQUIRE((i < 10 || std::abs(at.z()) < 1e-12));
  }
  REQUIRE(arrivals_far >= 9);
  REQUIRE(returns >= 9);
}

TEST_CASE("A recorded hand that does not turn follows a row a tick and stays at the last") {
  std::vector<HandPose> rows;
  for (int i = 0; i < 50; ++i) rows.push_back(unturned({i * 1e-5, 0, 0}));
  auto motion = PoseMotion::recorded(rows, period);
  for (const HandPose& row : rows) {
    REQUIRE((motion.next().position - row.position).norm() < 1e-12);
  }
  for (int i = 0; i < 10; ++i) {
    REQUIRE((motion.next().position - rows.back().position).norm() < 1e-12);
  }
  auto jump = PoseMotion::recorded({unturned({0, 0, 0}), unturned({0.1, 0, 0})}, period);
  Vector3 last = jump.start().position;
  for (int i = 0; i < 300; ++i) {
    const Vector3 at = jump.next().position;
    REQUIRE((at - last).norm() <= fastest_target * period * (1 + 1e-9));
    last = at;
  }
  REQUIRE((last - Vector3(0.1, 0, 0)).norm() < 1e-9);
}

}  // namespace pose_motion_test
