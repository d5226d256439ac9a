// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/led_motion.hpp"

#include <catch2/catch.hpp>
#include <limits>

#include "servo/devices/sim/device_sim.hpp"
#include "servo/devices/sim/pose_motion.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace led_motion_test {

using namespace spm;
using namespace spm::servo;

namespace {

constexpr double period = 1e-3;

HandPose at(double x) { return unturned(Vector3(x, 0, 0)); }

}  // namespace

TEST_CASE("A hand that is led comes to where it is led, and stays there") {
  LedMotion motion(at(0), period);
  SixdofTarget target;
  for (int tick = 0; tick < 100; ++tick) target = motion.next(at(0.005));
  CHECK(target.position.x() == Approx(0.005).epsilon(1e-3));
  CHECK(target.velocity.norm() < 1e-3);
}

TEST_CASE("A command that is far away, or comes rarely, gives no jump of the target") {
  const double far = GENERATE(0.002, 0.5, 100.0);
  LedMotion motion(at(0), period);
  Vector3 before = Vector3::Zero();
  for (int tick = 0; tick < 200; ++tick) {
    // A new one with each frame of a screen.
    const SixdofTarget target = motion.next(at(tick / 16 % 2 == 0 ? far : -far));
    CHECK((target.position - before).norm() <= fastest_target * period * (1 + 1e-12));
    CHECK(target.velocity.norm() <= fastest_target * (1 + 1e-12));
    before = target.position;
  }
}

TEST_CASE("A turn is followed no faster than a target may turn") {
  const HandPose turned{Vector3::Zero(), orientation_of(Vector3(0, 3, 0))};
  LedMotion motion(at(0), period);
  SixdofTarget target;
  for (int tick = 0; tick < 400; ++tick) {
    target = motion.next(turned);
    CHECK(target.angular_velocity.norm() <= fastest_turn * (1 + 1e-9));
  }
  CHECK(target.orientation.angularDistance(turned.orientation) < 1e-3);
}

TEST_CASE("A pose that is no number is not followed, and forgotten with the next that is one") {
  LedMotion motion(at(0), period);
  for (int tick = 0; tick < 100; ++tick) static_cast<void>(motion.next(at(0.005)));
  const double none = std::numeric_limits<double>::quiet_NaN();
  CHECK(motion.next(at(none)).position.x() == Approx(0.005).epsilon(1e-3));
  HandPose turned = at(0.005);
  turned.orientation.w() = none;
  CHECK(motion.next(turned).orientation.coeffs().allFinite());
  CHECK(motion.next(at(0.005)).position.x() == Approx(0.005).epsilon(1e-3));
}

TEST_CASE("A live hand presses a wall where it is led into it, and goes slack when it is let go") {
  const Asset asset = test::box_asset(0.04);
  const AssetTables tables = tables_of(asset);
  SimOptions options;
  options.hand = HandKind::live;
  DeviceSim device(options);
  const std::array<const AssetView*, 1> assets{&tables.view()};
  ForceSettings force;
  force.stiffness = 1000;
  REQUIRE(device.open({1000, RealtimeMode::off, scene_of(force), assets}));
  REQUIRE(device.capabilities().led);
  DeviceState state;
  double felt = 0;
  const auto run = [&](const HandPose* led, int ticks) {
    for (int tick = 0; tick < ticks; ++tick) {
      device.lead(led);
      REQUIRE(device.read(state) == DeviceHealth::ok);
      const ContactForce contact = contact_force(tables.view(), force, state.position);
      felt = contact.force.norm();
      REQUIRE(device.write({contact.force, Vector3::Zero()}) == DeviceHealth::ok);
    }
  };
  run(nullptr, 100);
  CHECK(state.position.z() > 0.03);
  CHECK(felt == 0);
  const HandPose inside = unturned(Vector3(0, 0, 0.018));
  run(&inside, 600);
  // The grip of 700 N/m and the wall of 1000 N/m share the way of 2 mm.
  CHECK(0.02 - state.position.z() == Approx(0.002 * 700 / 1700).epsilon(0.03));
  CHECK(felt == Approx(1000 * (0.02 - state.position.z())).epsilon(0.01));
  run(nullptr, 400);
  CHECK(felt < 0.05);
}

}  // namespace led_motion_test
