// SPDX-License-Identifier: Apache-2.0
#include "common/contact/hand_effect.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>

namespace hand_effect_test {

using namespace spm;

namespace {

/// A ball of 20 mm at the origin, as a surface.
NearSurface ball(const Vector3& from) { return {from.norm() - 0.02, from.normalized(), 0.003}; }

Vector3 force_at(const HandEffect& effect, const Vector3& tool) {
  return hand_effect_force(effect, tool, Vector3::Zero(), ball(tool));
}

/// J: the work on a tool that goes round once about a centre, in the plane of x and y.
double work_around(const HandEffect& effect, const Vector3& centre, double radius) {
  constexpr int steps = 20000;
  double work = 0;
  const auto place = [&](double step) {
    const double angle = 2 * std::numbers::pi * step / steps;
    return Vector3(centre + radius * Vector3(std::cos(angle), std::sin(angle), 0));
  };
  for (int i = 0; i < steps; ++i) {
    work += force_at(effect, place(i + 0.5)).dot(place(i + 1) - place(i));
  }
  return work;
}

}  // namespace

TEST_CASE("A pull rises with its stiffness, stays at its most, and is gone at its range") {
  CHECK(pull(0, 100, 0.01, 1) == 0);
  CHECK(pull(0.001, 100, 0.01, 1) == Approx(0.1));
  CHECK(pull(0.005, 100, 0.01, 0.2) == Approx(0.2));
  CHECK(pull(0.009, 100, 0.01, 1) == Approx(0.1));
  CHECK(pull(0.01, 100, 0.01, 1) == 0);
  CHECK(pull(0.02, 100, 0.01, 1) == 0);
  const double none = std::numeric_limits<double>::infinity();
  CHECK(pull(0.5, 100, none, none) == Approx(50));
}

TEST_CASE("Spring, magnet and detents give no work on any way that comes back") {
  HandEffect effect;
  effect.stiffness = 300;
  effect.range = 0.012;
  effect.most_force = 0.8;
  effect.kind = GENERATE(HandEffectKind::spring, HandEffectKind::magnet, HandEffectKind::detents);
  if (effect.kind == HandEffectKind::magnet) effect.range = 0.002;
  effect.axis = {0.6, 0.8, 0};
  effect.spacing = 0.003;
  CAPTURE(static_cast<int>(effect.kind));
  for (const double radius : {0.001, 0.007, 0.02}) {
    CHECK(std::abs(work_around(effect, {0.0205, 0, 0}, radius)) < 1e-7);
  }
}

TEST_CASE("A magnet pulls from outside alone, and no farther than the distance is known") {
  HandEffect magnet;
  magnet.kind = HandEffectKind::magnet;
  magnet.stiffness = 200;
  magnet.range = 0.01;
  CHECK(force_at(magnet, {0.021, 0, 0}).isApprox(Vector3(-0.2, 0, 0)));
  CHECK(force_at(magnet, {0.023, 0, 0}).isZero());
  CHECK(force_at(magnet, {0.019, 0, 0}).isZero());
  CHECK(hand_effect_force(magnet, {0.021, 0, 0}, Vector3::Zero(), {}).isZero());
}

TEST_CASE(
    "A magnet brakes along the normal: not at the surface, fully from a quarter of its range on") {
  HandEffect magnet;
  magnet.kind = HandEffectKind::magnet;
  magnet.stiffness = 200;
  magnet.range = 0.002;
  magnet.damping = 3;
  const Vector3 velocity(0.1, 0.2, 0);
  const auto brake = [&](double distance) {
    const Vector3 tool(0.02 + distance, 0, 0);
    return (hand_effect_force(magnet, tool, velocity, ball(tool)) - force_at(magnet, tool)).x();
  };
  CHECK(brake(1e-9) == Approx(0).margin(1e-5));
  CHECK(brake(0.000125) == Approx(-0.3 / 4));
  CHECK(brake(0.00025) == Approx(-0.3 / 2));
  CHECK(brake(0.0005) == Approx(-0.3));
  CHECK(brake(0.0015) == Approx(-0.3));
  CHECK(brake(0.00175) == Approx(-0.3 / 2));
}

TEST_CASE("Detents pull along their axis to the nearest, and none lies beyond their range") {
  HandEffect detents;
  detents.kind = HandEffectKind::detents;
  detents.stiffness = 100;
  detents.axis = {1, 0, 0};
  detents.spacing = 0.004;
  CHECK(force_at(detents, {0.0041, 0.3, 0.2}).isApprox(Vector3(-0.01, 0, 0)));
  CHECK(force_at(detents, {-0.0041, 0, 0}).isApprox(Vector3(0.01, 0, 0)));
  CHECK(force_at(detents, {0.006, 0, 0}).norm() < 1e-12);
  detents.range = 0.005;
  CHECK(force_at(detents, {0.0079, 0, 0}).isZero());
  CHECK(force_at(detents, {0.0039, 0, 0}).isApprox(Vector3(0.01, 0, 0)));
}

TEST_CASE("A viscous effect brakes, and no harder than its most") {
  HandEffect brake;
  brake.kind = HandEffectKind::viscous;
  brake.damping = 2;
  const Vector3 velocity(0.3, 0, -0.4);
  CHECK(hand_effect_force(brake, Vector3::Zero(), velocity, {}).isApprox(-2 * velocity));
  brake.most_force = 0.5;
  CHECK(hand_effect_force(brake, Vector3::Zero(), velocity, {}).isApprox(-velocity));
}

}  // namespace hand_effect_test
