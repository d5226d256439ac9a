// SPDX-License-Identifier: Apache-2.0
#include "common/contact/coulomb_friction.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace spm::coulomb_friction_test {
namespace {

const FrictionSettings settings{0.5, 0.3, 1000};
const Vector3 up = Vector3::UnitZ();

TEST_CASE("A point that touches anew feels no friction, and then hangs on its anchor") {
  FrictionState state;
  CHECK(coulomb_friction(settings, {0, 0, 0}, up, 2, state).isZero());
  const Vector3 force = coulomb_friction(settings, {1e-4, 0, 0}, up, 2, state);
  CHECK((force - Vector3(-0.1, 0, 0)).norm() < 1e-12);
  CHECK_FALSE(state.sliding);
}

TEST_CASE("It sticks up to mu at rest, and then slides with mu in motion") {
  FrictionState state;
  double largest = 0;
  Vector3 force = Vector3::Zero();
  for (int i = 0; i <= 300; ++i) {
    force = coulomb_friction(settings, {1e-5 * i, 0, 0}, up, 2, state);
    largest = std::max(largest, force.norm());
  }
  CHECK(largest == Approx(0.5 * 2));
  CHECK(force.x() == Approx(-0.3 * 2));
  CHECK(state.sliding);
  // When the motion turns round, the spring first gives way, and the point sticks again.
  force = coulomb_friction(settings, {1e-5 * 290, 0, 0}, up, 2, state);
  CHECK_FALSE(state.sliding);
  CHECK(force.x() == Approx(-0.6 + 0.1));
}

TEST_CASE("Friction is tangential and never exceeds mu times what presses") {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> step(0, 3e-5), turn(0, 0.05);
    std::uniform_real_distribution<double> pressing(0.01, 3);
    FrictionState state;
    Vector3 point = Vector3::Zero(), normal = up;
    for (int i = 0; i < 500; ++i) {
      point += Vector3(step(random), step(random), step(random));
      normal = (normal + Vector3(turn(random), turn(random), turn(random))).normalized();
      const double pressed = pressing(random);
      const Vector3 force = coulomb_friction(settings, point, normal, pressed, state);
      REQUIRE(force.norm() <= settings.stick * pressed * (1 + 1e-12));
      REQUIRE(std::abs(force.dot(normal)) < 1e-12);
    }
  }
}

TEST_CASE("At rest it is as quiet as the position") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> noise(-1e-6, 1e-6);
  FrictionState state;
  for (int i = 0; i < 20; ++i) (void)coulomb_friction(settings, {1e-5 * i, 0, 0}, up, 2, state);
  Vector3 last = coulomb_friction(settings, {2e-4, 0, 0}, up, 2, state);
  for (int i = 0; i < 500; ++i) {
    const Vector3 force =
        coulomb_friction(settings, {2e-4 + noise(random), noise(random), 0}, up, 2, state);
    REQUIRE((force - last).norm() <= settings.stiffness * 2e-6 * std::numbers::sqrt2 + 1e-12);
    REQUIRE(force.x() < 0);
    last = force;
  }
}

TEST_CASE("A closed path that sticks costs no work, one that slides costs some") {
  const auto work = [](double radius) {
    FrictionState state;
    double sum = 0;
    Vector3 last(radius, 0, 0), pull = coulomb_friction(settings, last, up, 2, state);
    for (int i = 1; i <= 4000; ++i) {
      const double turn = 2 * std::numbers::pi * i / 2000;
      const Vector3 point(radius * std::cos(turn), radius * std::sin(turn), 0);
      const Vector3 force = coulomb_friction(settings, point, up, 2, state);
      sum += (force + pull).dot(point - last) / 2;
      last = point;
      pull = force;
    }
    return sum;
  };
  CHECK(std::abs(work(2e-4)) < 1e-12);
  CHECK(work(5e-3) < -0.3 * 2 * 2 * 2 * std::numbers::pi * 5e-3 * 0.9);
}

TEST_CASE("Without contact it lets go and forgets") {
  FrictionState state;
  (void)coulomb_friction(settings, {0, 0, 0}, up, 2, state);
  (void)coulomb_friction(settings, {2e-4, 0, 0}, up, 2, state);
  CHECK(coulomb_friction(settings, {2e-4, 0, 0}, up, 0, state).isZero());
  CHECK_FALSE(state.held);
  CHECK(coulomb_friction(settings, {3e-4, 0, 0}, up, 2, state).isZero());
}

TEST_CASE("What is no number gives no friction and lets go") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double pressing : {nan, infinity, -1.0}) {
    FrictionState state{true, false, Vector3(1e-4, 0, 0)};
    CHECK(coulomb_friction(settings, {0, 0, 0}, up, pressing, state).isZero());
    CHECK_FALSE(state.held);
  }
  FrictionState state{true, false, Vector3(1e-4, 0, 0)};
  CHECK(coulomb_friction(settings, {nan, 0, 0}, up, 1, state).isZero());
  CHECK_FALSE(state.held);
}

}  // namespace
}  // namespace spm::coulomb_friction_test
