// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/falcon/falcon_tracker.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/servo/devices/falcon/falcon_counts.hpp"

namespace falcon_tracker_test {

using namespace spm;
using namespace spm::servo;
using spm::test::falcon_counts;

namespace {

constexpr std::int64_t millisecond = 1'000'000;  // ns

/// A homed report of a position.
FalconReport report_at(const Vector3& position) {
  const auto angles = falcon_inverse(position);
  REQUIRE(angles);
  const Vector3 counts = falcon_counts(*angles);
  FalconReport report;
  for (Eigen::Index i = 0; i < 3; ++i) {
    report.encoders[static_cast<std::size_t>(i)] =
        static_cast<std::int16_t>(std::lround(counts[i]));
  }
  report.homed = falcon_all_homed;
  return report;
}

}  // namespace

TEST_CASE("A tracker gives the position of a report within the encoders' step") {
  FalconTracker tracker(falcon_home_angle);
  std::int64_t now = 0;
  for (int i = 0; i < 5000; ++i) {
    const double t = 1e-3 * i;
    const Vector3 position(0.04 * std::sin(3 * t), 0.04 * std::sin(2 * t), 0.03 * std::sin(5 * t));
    now += millisecond;
    REQUIRE(tracker.follow(report_at(position), now) == DeviceHealth::ok);
    REQUIRE((tracker.position() - position).norm() < 100e-6);
  }
}

TEST_CASE("Until all three encoders are homed there is no position, whatever they count") {
  FalconTracker tracker(falcon_home_angle);
  FalconReport report = report_at({0.01, 0, 0});
  for (std::uint8_t homed = 0; homed < falcon_all_homed; ++homed) {
    report.homed = homed;
    REQUIRE(tracker.follow(report, millisecond) == DeviceHealth::not_homed);
  }
  report.homed = falcon_all_homed;
  REQUIRE(tracker.follow(report, 2 * millisecond) == DeviceHealth::ok);
}

TEST_CASE("A hand that jumps farther than one can move is a fault, until time explains it") {
  FalconTracker tracker(falcon_home_angle);
  REQUIRE(tracker.follow(report_at({0, 0, 0}), 0) == DeviceHealth::ok);
  const FalconReport far = report_at({0.018, 0, 0});
  REQUIRE(tracker.follow(far, millisecond) == DeviceHealth::fault);
  REQUIRE(tracker.position().norm() < 100e-6);
  REQUIRE(tracker.follow(report_at({0.001, 0, 0}), 2 * millisecond) == DeviceHealth::ok);
  REQUIRE(tracker.follow(far, 3 * millisecond) == DeviceHealth::fault);
  REQUIRE(tracker.follow(far, 20 * millisecond) == DeviceHealth::ok);
}

TEST_CASE("A Falcon that jumps by more than 20 mm has to home again, or to be opened again") {
  FalconTracker tracker(falcon_home_angle);
  REQUIRE(tracker.follow(report_at({0, 0, 0}), 0) == DeviceHealth::ok);
  REQUIRE(tracker.follow(report_at({0.03, 0, 0}), millisecond) == DeviceHealth::fault);
  for (int i = 2; i < 100; ++i) {
    REQUIRE(tracker.follow(report_at({0, 0, 0}), i * millisecond) == DeviceHealth::not_homed);
  }
  FalconReport homing = report_at({0, 0, 0});
  homing.homed = 3;
  REQUIRE(tracker.follow(homing, 100 * millisecond) == DeviceHealth::not_homed);
  REQUIRE(tracker.follow(report_at({0, 0, 0}), 101 * millisecond) == DeviceHealth::ok);
  REQUIRE(tracker.follow(report_at({0.03, 0, 0}), 102 * millisecond) == DeviceHealth::fault);
  tracker.restart();
  REQUIRE(tracker.follow(report_at({0, 0, 0}), 103 * millisecond) == DeviceHealth::ok);
}

TEST_CASE("A jump through homing, or after the device was opened again, is none") {
  FalconTracker tracker(falcon_home_angle);
  REQUIRE(tracker.follow(report_at({0, 0, 0}), 0) == DeviceHealth::ok);
  FalconReport report = report_at({0.03, 0, 0});
  report.homed = 3;
  REQUIRE(tracker.follow(report, millisecond) == DeviceHealth::not_homed);
  REQUIRE(tracker.follow(report_at({0.03, 0, 0}), 2 * millisecond) == DeviceHealth::ok);
  tracker.restart();
  REQUIRE(tracker.follow(report_at({-0.03, 0, 0}), 3 * millisecond) == DeviceHealth::ok);
}

TEST_CASE("Counts of no position in the workspace are a fault") {
  FalconTracker tracker(falcon_home_angle);
  FalconReport report;
  report.homed = falcon_all_homed;
  for (const std::array<std::int16_t, 3>& counts :
       {std::array<std::int16_t, 3>{32767, -32768, 0}, std::array<std::int16_t, 3>{-2400, 2400, 0},
        std::array<std::int16_t, 3>{-4000, -4000, -4000}}) {
    report.encoders = counts;
    REQUIRE(tracker.follow(report, millisecond) == DeviceHealth::fault);
  }
  REQUIRE(tracker.follow(report_at({0, 0, 0}), 2 * millisecond) == DeviceHealth::ok);
}

TEST_CASE("Encoders that stand still under a large force for long are a fault until they count") {
  FalconTracker tracker(falcon_home_angle);
  const FalconReport still = report_at({0.01, 0.01, 0});
  std::int64_t now = 0;
  const auto hold = [&](double seconds, double force) {
    DeviceHealth health = DeviceHealth::ok;
    for (int i = 0; i < seconds * 1000; ++i) {
      now += millisecond;
      health = tracker.follow(still, now);
      tracker.pushed(health == DeviceHealth::ok ? force : 0);
    }
    return health;
  };
  REQUIRE(hold(10, 0) == DeviceHealth::ok);
  REQUIRE(hold(10, 3.9) == DeviceHealth::ok);
  REQUIRE(hold(1.9, 5) == DeviceHealth::ok);
  REQUIRE(hold(0.1, 0) == DeviceHealth::ok);
  REQUIRE(hold(1.9, 5) == DeviceHealth::ok);
  now += 3000 * millisecond;  // the loop stalled, and the device was sent no force
  REQUIRE(hold(1.9, 5) == DeviceHealth::ok);
  REQUIRE(hold(0.3, 5) == DeviceHealth::fault);
  REQUIRE(hold(10, 5) == DeviceHealth::fault);
  FalconReport moved = still;
  ++moved.encoders[1];
  now += millisecond;
  REQUIRE(tracker.follow(moved, now) == DeviceHealth::ok);
}

}  // namespace falcon_tracker_test
