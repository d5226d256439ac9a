// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/spacemouse/spacemouse_motion.hpp"

#include <catch2/catch.hpp>
#include <numbers>

#include "common/base/random.hpp"

namespace spacemouse_motion_test {

using namespace spm;
using namespace spm::servo;

namespace {

std::array<double, 3> axes_of(const Vector3& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

}  // namespace

TEST_CASE("Full deflection moves the tool at the speed of the options") {
  SpaceMouseOptions options;
  options.speed = 0.2;
  SpaceMouseMotion motion(options);
  SpaceMouseState mouse;
  mouse.push = {0, 1, 0};
  for (int i = 0; i < 500; ++i) motion.step(mouse, 1e-3);
  REQUIRE((motion.position() - Vector3(0, 0.1, 0)).norm() < 1e-9);
  REQUIRE(motion.orientation().isApprox(Eigen::Quaterniond::Identity()));
}

TEST_CASE("Let go, the tool stays where it is") {
  SpaceMouseMotion motion{SpaceMouseOptions{}};
  SpaceMouseState mouse;
  mouse.push = {0.5, -1, 0};
  mouse.twist = {0, 0.3, 1};
  for (int i = 0; i < 100; ++i) motion.step(mouse, 1e-3);
  const Vector3 position = motion.position();
  const Eigen::Quaterniond orientation = motion.orientation();
  for (int i = 0; i < 100; ++i) motion.step({}, 1e-3);
  REQUIRE(motion.position() == position);
  REQUIRE(motion.orientation().coeffs() == orientation.coeffs());
}

TEST_CASE("Full twist about an axis turns the tool about the world's at the speed of the options") {
  SpaceMouseMotion motion{SpaceMouseOptions{}};
  SpaceMouseState mouse;
  mouse.twist = {1, 0, 0};
  for (int i = 0; i < 1000; ++i) motion.step(mouse, 1e-3);
  mouse.twist = {0, 1, 0};
  for (int i = 0; i < 1000; ++i) motion.step(mouse, 1e-3);
  const Eigen::Quaterniond expected(Eigen::AngleAxisd(std::numbers::pi / 2, Vector3::UnitY()) *
                                    Eigen::AngleAxisd(std::numbers::pi / 2, Vector3::UnitX()));
  REQUIRE(motion.orientation().angularDistance(expected) < 1e-9);
}

TEST_CASE("Within the dead zone nothing moves, and beyond it the motion begins without a step") {
  REQUIRE(beyond_dead_zone(0.05, 0.05) == 0);
  REQUIRE(beyond_dead_zone(-0.05, 0.05) == 0);
  REQUIRE(beyond_dead_zone(0.0501, 0.05) == Approx(0.0001 / 0.95));
  REQUIRE(beyond_dead_zone(1, 0.05) == 1);
  REQUIRE(beyond_dead_zone(-1, 0.05) == -1);
  REQUIRE(beyond_dead_zone(0.001, 0) == 0.001);
}

TEST_CASE("The tool never leaves its box, and its turn stays a unit one") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    SpaceMouseOptions options;
    options.speed = 1;
    options.box = 0.1;
    SpaceMouseMotion motion(options);
    double furthest = 0;
    for (int i = 0; i < 5000; ++i) {
      SpaceMouseState mouse;
      mouse.push = axes_of(random.direction());
      mouse.twist = axes_of(random.direction());
      motion.step(mouse, random.between(0, 0.02));
      furthest = std::max(furthest, motion.position().cwiseAbs().maxCoeff());
      REQUIRE(std::abs(motion.orientation().norm() - 1) < 1e-12);
    }
    REQUIRE(furthest == 0.05);
  }
}

}  // namespace spacemouse_motion_test
