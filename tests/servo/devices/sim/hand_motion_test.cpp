// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/hand_motion.hpp"

#include <catch2/catch.hpp>

#include "common/base/random.hpp"

namespace hand_motion_test {

using namespace spm::servo;
using spm::Random;
using spm::Vector3;

namespace {

constexpr double period = 1e-3;

std::vector<Vector3> random_points(std::uint64_t seed, std::size_t count) {
  Random random(seed);
  std::vector<Vector3> points;
  for (std::size_t i = 0; i < count; ++i) points.push_back(0.001 * random.direction());
  return points;
}

}  // namespace

TEST_CASE("A sweep moves at its speed, never faster, and turns between the two ends") {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    auto motion = HandMotion::back_and_forth(random_points(seed, 8), 1, 0.04, period);
    Vector3 last = motion.start();
    for (int i = 0; i < 3000; ++i) {
      const HandTarget target = motion.next();
      REQUIRE((target.position - last).norm() <= 0.04 * period * (1 + 1e-9));
      REQUIRE((target.velocity * period - (target.position - last)).norm() < 1e-12);
      last = target.position;
    }
  }
}

TEST_CASE("A sweep comes to every point and comes back") {
  const std::vector<Vector3> points{{0, 0, 1e-3}, {0, 0, 0}, {1e-3, 0, 0}};
  auto motion = HandMotion::back_and_forth(points, 1, 0.1, period);
  int arrivals_far = 0;
  int returns = 0;
  for (int i = 0; i < 200; ++i) {
    const Vector3 at = motion.next().position;
    arrivals_far += at.isApprox(points[2], 1e-9) ? 1 : 0;
    returns += at.norm() < 1e-12 ? 1 : 0;
    REQUIRE((i < 10 || std::abs(at.z()) < 1e-12));
  }
  REQUIRE(arrivals_far >= 9);
  REQUIRE(returns >= 9);
}

TEST_CASE("A press goes to its target and stays") {
  auto motion = HandMotion::press({0, 0, 0}, {0, 0, -1e-3}, 0.04, period);
  HandTarget target;
  for (int i = 0; i < 100; ++i) target = motion.next();
  REQUIRE(target.position == Vector3(0, 0, -1e-3));
  REQUIRE(target.velocity == Vector3::Zero());
}

TEST_CASE("A recorded hand follows a row a tick and stays at the last") {
  std::vector<Vector3> rows;
  for (int i = 0; i < 50; ++i) rows.emplace_back(i * 1e-5, 0, 0);
  auto motion = HandMotion::recorded(rows, period);
  for (int i = 0; i < 50; ++i) REQUIRE((motion.next().position - rows[i]).norm() < 1e-12);
  for (int i = 0; i < 10; ++i) REQUIRE((motion.next().position - rows.back()).norm() < 1e-12);
}

TEST_CASE("A jump in a recording becomes a fast move") {
  auto motion = HandMotion::recorded({{0, 0, 0}, {0.1, 0, 0}}, period);
  Vector3 last = motion.start();
  for (int i = 0; i < 300; ++i) {
    const Vector3 at = motion.next().position;
    REQUIRE((at - last).norm() <= fastest_target * period * (1 + 1e-9));
    last = at;
  }
  REQUIRE((last - Vector3(0.1, 0, 0)).norm() < 1e-9);
}

TEST_CASE("Points that all lie on one place end nothing") {
  auto motion =
      HandMotion::back_and_forth(std::vector<Vector3>(5, Vector3::Ones()), 1, 0.04, period);
  for (int i = 0; i < 100; ++i) REQUIRE(motion.next().position == Vector3::Ones());
}

}  // namespace hand_motion_test
