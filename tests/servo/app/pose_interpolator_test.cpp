// SPDX-License-Identifier: Apache-2.0
#include "servo/app/pose_interpolator.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "common/base/random.hpp"

namespace pose_interpolator_test {

using namespace spm;
using namespace spm::servo;

namespace {

constexpr std::int64_t tick_ns = 1'000'000;

Placement placed(const Vector3& position,
                 const Eigen::Quaterniond& rotation = Eigen::Quaterniond::Identity()) {
  Placement placement;
  placement.position = position;
  placement.rotation = rotation;
  return placement;
}

Eigen::Quaterniond turned_by(double angle, const Vector3& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis.normalized()));
}

/// Poses of something that moves evenly, given at a rate, each late by up to `jitter` seconds.
struct Stream {
  double rate = 90;
  Vector3 velocity{0.1, 0, 0};  // m/s
  double jitter = 0;
  std::uint64_t seed = 0;
};

/// The interpolated poses at 1 kHz over `seconds`.
std::vector<InterpolatedPose> play(const Stream& stream, double seconds,
                                   PoseInterpolator& interpolator) {
  Random random(stream.seed);
  std::vector<InterpolatedPose> poses;
  int frame = 0;
  double due = 0;
  for (std::int64_t tick = 0; static_cast<double>(tick) * 1e-3 < seconds; ++tick) {
    const double now = static_cast<double>(tick) * 1e-3;
    while (due <= now) {
      interpolator.give(placed(stream.velocity * (frame / stream.rate)), 1 / stream.rate,
                        tick * tick_ns);
      ++frame;
      due = frame / stream.rate + random.between(0, stream.jitter);
    }
    poses.push_back(interpolator.at(tick * tick_ns));
  }
  return poses;
}

/// The least and the largest step from tick to tick, m, from a time on.
std::pair<double, double> steps(const std::vector<InterpolatedPose>& poses, std::size_t from) {
  double least = 1e9, most = 0;
  for (std::size_t i = from + 1; i < poses.size(); ++i) {
    const double step = (poses[i].pose.position - poses[i - 1].pose.position).norm();
    least = std::min(least, step);
    most = std::max(most, step);
  }
  return {least, most};
}

}  // namespace

TEST_CASE("An object at 0.1 m/s with poses at 90 Hz moves in even steps of 0.1 mm a tick") {
  for (const double rate : {60.0, 72.0, 90.0, 120.0}) {
    PoseInterpolator interpolator({}, Placement());
    const auto poses = play({rate}, 2, interpolator);
    // Poses reach the loop on whole ticks. This alone moves a step by a tick in a stretched period.
    const double slack = 1e-4 * 1e-3 * rate;
    const auto [least, most] = steps(poses, 500);
    CAPTURE(rate, least, most);
    REQUIRE(least > 1e-4 - slack);
    REQUIRE(most < 1e-4 + slack);
    REQUIRE(interpolator.period() == Approx(1 / rate).margin(5e-4));
  }
}

TEST_CASE("Poses that come late by up to 3 ms neither stop the object nor make it jump") {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    PoseInterpolator interpolator({}, Placement());
    const auto poses = play({90, {0.06, -0.08, 0}, 0.0025, seed}, 3, interpolator);
    const auto [least, most] = steps(poses, 500);
    CAPTURE(seed, least, most);
    REQUIRE(least > 0.4e-4);
    REQUIRE(most < 1.6e-4);
  }
}

TEST_CASE("The object follows at its speed, a fraction over one period behind") {
  PoseInterpolator interpolator({}, Placement());
  const auto poses = play({90}, 2, interpolator);
  for (std::size_t i = 1000; i < poses.size(); ++i) {
    const double behind = static_cast<double>(i) * 1e-4 - poses[i].pose.position.x();
    REQUIRE(behind >= 0);
    REQUIRE(behind < 0.1 * (PoseInterpolator::stretch / 90 + 1e-3));
    REQUIRE(poses[i].velocity.x() == Approx(0.1).epsilon(0.1));
  }
}

TEST_CASE("Between two poses the way is even, and ends at the pose exactly") {
  PoseInterpolator interpolator({}, Placement());
  const Placement goal = placed({0.01, 0.02, -0.01}, turned_by(0.1, {1, 2, 3}));
  interpolator.give(goal, 0.02, 0);
  const double duration = 0.02 * PoseInterpolator::stretch;
  const auto middle = interpolator.at(static_cast<std::int64_t>(duration * 0.5e9));
  REQUIRE((middle.pose.position - goal.position / 2).norm() < 1e-12);
  REQUIRE(middle.pose.rotation.angularDistance(turned_by(0.05, {1, 2, 3})) < 1e-9);
  REQUIRE((middle.velocity - goal.position / duration).norm() < 1e-9);
  REQUIRE(middle.angular_velocity.norm() == Approx(0.1 / duration));
  const auto end = interpolator.at(static_cast<std::int64_t>(duration * 1e9) + 1);
  REQUIRE(end.pose.position == goal.position);
  REQUIRE(end.pose.rotation.coeffs() == goal.rotation.coeffs());
  REQUIRE(end.velocity == Vector3::Zero());
}

TEST_CASE("No pose moves an object faster than the caps") {
  PoseInterpolatorSettings settings;
  settings.max_speed = 0.5;
  settings.max_turn = 2;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Random random(seed);
    PoseInterpolator interpolator(settings, Placement());
    InterpolatedPose last = interpolator.at(0);
    double due = 0;
    for (std::int64_t tick = 1; tick < 1000; ++tick) {
      if (static_cast<double>(tick) >= due) {
        interpolator.give(placed(random.direction() * random.between(0, 5),
                                 turned_by(random.between(-3, 3), random.direction())),
                          random.between(0, 0.02), tick * tick_ns);
        due += random.between(0, 40);
      }
      const InterpolatedPose now = interpolator.at(tick * tick_ns);
      REQUIRE(now.pose.position.allFinite());
      REQUIRE((now.pose.position - last.pose.position).norm() <= 0.5e-3 * (1 + 1e-9));
      REQUIRE(now.pose.rotation.angularDistance(last.pose.rotation) <= 2e-3 * (1 + 1e-6) + 1e-7);
      REQUIRE(std::abs(now.pose.rotation.norm() - 1) < 1e-9);
      REQUIRE(now.velocity.norm() <= 0.5 * (1 + 1e-9));
      last = now;
    }
  }
}

TEST_CASE("An object that jumps arrives at its pose later, by the cap") {
  PoseInterpolatorSettings settings;
  settings.max_speed = 0.5;
  PoseInterpolator interpolator(settings, Placement());
  interpolator.give(placed({1, 0, 0}), 0.01, 0);
  REQUIRE(interpolator.at(1'000'000'000).pose.position.x() == Approx(0.5));
  REQUIRE(interpolator.at(2'000'000'000).pose.position.x() == 1);
}

TEST_CASE("An application that falls silent leaves the last pose, and it is told for how long") {
  PoseInterpolator interpolator({}, placed({1, 2, 3}));
  InterpolatedPose now = interpolator.at(5'000'000'000);
  REQUIRE_FALSE(now.driven);
  REQUIRE(now.silent == 0);
  REQUIRE(now.pose.position == Vector3(1, 2, 3));
  interpolator.give(placed({1, 2, 3.001}), 0.01, 5'000'000'000);
  now = interpolator.at(7'500'000'000);
  REQUIRE(now.driven);
  REQUIRE(now.silent == Approx(2.5));
  REQUIRE(now.pose.position == Vector3(1, 2, 3.001));
  REQUIRE(now.velocity == Vector3::Zero());
}

TEST_CASE("After a silence the measured time between poses still stands") {
  PoseInterpolator interpolator({}, Placement());
  static_cast<void>(play({90}, 1, interpolator));
  const double before = interpolator.period();
  interpolator.give(placed({0, 0, 0}), 0, 60'000'000'000);
  REQUIRE(interpolator.period() == before);
}

TEST_CASE("One frame that took long hardly changes the measured time between poses") {
  PoseInterpolator interpolator({}, Placement());
  static_cast<void>(play({90}, 1, interpolator));
  const double before = interpolator.period();
  interpolator.give(placed({0.1, 0, 0}), 0, 1'200'000'000);
  REQUIRE(interpolator.period() > before);
  REQUIRE(interpolator.period() < 1.2 * before);
}

TEST_CASE("The same frame told twice is not measured") {
  PoseInterpolator interpolator({}, Placement());
  interpolator.give(placed({0, 0, 0}), 0, 0);
  interpolator.give(placed({0.001, 0, 0}), 0, 10'000'000);
  REQUIRE(interpolator.period() == Approx(0.01));
  interpolator.give(placed({0.001, 0, 0}), 0, 10'100'000);
  REQUIRE(interpolator.period() == Approx(0.01));
}

TEST_CASE("Poses tell whether an object was left amid a motion, or had stopped") {
  PoseInterpolator interpolator({}, Placement());
  std::int64_t now = 1'000'000'000;
  const auto give = [&](const Vector3& at, double seconds, double turn = 0) {
    now += static_cast<std::int64_t>(seconds * 1e9);
    interpolator.give(placed(at, turned_by(turn, {0, 0, 1})), 0, now);
    return interpolator.ended_amid_motion();
  };
  // The first pose of an object tells no motion.
  CHECK_FALSE(give({0.5, 0, 0}, 0.01));
  CHECK(give({0.501, 0, 0}, 0.01));
  CHECK(give({0.502, 0, 0}, 0.01));
  SECTION("its last pose twice") { CHECK_FALSE(give({0.502, 0, 0}, 0.01)); }
  SECTION("its last pose twice in one frame") { CHECK_FALSE(give({0.502, 0, 0}, 1e-5)); }
  SECTION("slower and slower") { CHECK_FALSE(give({0.5021, 0, 0}, 0.01)); }
  SECTION("another pose in one frame") { CHECK(give({0.503, 0, 0}, 1e-5)); }
  SECTION("it turns") { CHECK(give({0.502, 0, 0}, 0.01, 0.01)); }
  SECTION("a single pose long after") { CHECK_FALSE(give({0.8, 0, 0}, 1)); }
}

TEST_CASE("An object turns the shorter way, whichever sign its quaternion has") {
  PoseInterpolator interpolator({}, placed({0, 0, 0}, turned_by(3, {0, 0, 1})));
  Eigen::Quaterniond goal = turned_by(-3, {0, 0, 1});
  goal.coeffs() = -goal.coeffs();
  interpolator.give(placed({0, 0, 0}, goal), 0.1, 0);
  double travelled = 0;
  Eigen::Quaterniond last = interpolator.at(0).pose.rotation;
  for (std::int64_t tick = 1; tick < 400; ++tick) {
    const Eigen::Quaterniond now = interpolator.at(tick * tick_ns).pose.rotation;
    travelled += now.angularDistance(last);
    last = now;
  }
  REQUIRE(travelled == Approx(2 * M_PI - 6).epsilon(1e-3));
}

TEST_CASE("The scale stays as it was") {
  Placement start;
  start.scale = 3;
  PoseInterpolator interpolator({}, start);
  interpolator.give(placed({0.1, 0, 0}), 0.01, 0);
  REQUIRE(interpolator.at(5'000'000).pose.scale == 3);
  REQUIRE(interpolator.at(5'000'000'000).pose.scale == 3);
}

}  // namespace pose_interpolator_test
