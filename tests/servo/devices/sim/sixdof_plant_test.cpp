// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/sixdof_plant.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

namespace spm::servo::sixdof_plant_test {
namespace {

using Eigen::Isometry3d;

/// A device without damping, friction, encoders or lag worth the name, that nobody holds.
SixdofSettings free_body() {
  SixdofSettings settings;
  settings.profile.damping = 0;
  settings.profile.friction = 0;
  settings.profile.bandwidth = 0;
  settings.encoder_step = 0;
  settings.delay_ticks = 0;
  settings.hand = HandModel::none;
  return settings;
}

Isometry3d some_pose() {
  return Eigen::Translation3d(0.01, -0.02, 0.03) *
         Eigen::AngleAxisd(0.4, Vector3(1, 2, -1).normalized());
}

TEST_CASE("A free body keeps its momentum, its spin and its energy, however it tumbles") {
  SixdofSettings settings = free_body();
  settings.gyration = {0.01, 0.02, 0.035};
  SixdofPlant plant(settings);
  plant.place(some_pose());
  plant.set_motion({0.1, 0.2, -0.3}, {3, -8, 5});
  const Vector3 momentum = plant.angular_momentum();
  const Vector3 rates = plant.angular_velocity();
  const double energy = plant.kinetic_energy();
  for (int tick = 0; tick < 2000; ++tick) plant.step({}, {});
  CHECK((plant.velocity() - Vector3(0.1, 0.2, -0.3)).norm() < 1e-15);
  CHECK((plant.angular_momentum() - momentum).norm() < 1e-11 * momentum.norm());
  CHECK(plant.kinetic_energy() == Approx(energy).epsilon(1e-6));
  CHECK((plant.pose().translation() - some_pose().translation() - 2 * plant.velocity()).norm() <
        1e-12);
  // It does tumble: a body whose radii differ changes its rates.
  CHECK((plant.angular_velocity() - rates).norm() > 1);
}

TEST_CASE("A body spun up by a torque about one axis turns as the closed form says") {
  SixdofPlant plant(free_body());
  plant.place(Isometry3d::Identity());
  constexpr double torque = 1e-3, seconds = 0.2;
  for (int tick = 0; tick < 200; ++tick) plant.step({{}, {0, 0, torque}}, {});
  const double inertia = plant.inertia().z();
  CHECK(plant.angular_velocity().z() == Approx(torque * seconds / inertia).epsilon(1e-9));
  const Vector3 turn =
      turn_between(Eigen::Quaterniond::Identity(), Eigen::Quaterniond(plant.pose().linear()));
  CHECK(turn.z() == Approx(torque * seconds * seconds / (2 * inertia)).epsilon(1e-6));
  CHECK(turn.head<2>().norm() < 1e-12);
}

/// Period of the turn about x in a grip, by the zero crossings; s.
double period_of_swing(SixdofPlant& plant, int ticks) {
  double first = 0, last = 0, before = 0;
  int crossings = 0;
  for (int tick = 1; tick <= ticks; ++tick) {
    plant.step({}, {});
    const double angle =
        turn_between(Eigen::Quaterniond::Identity(), Eigen::Quaterniond(plant.pose().linear())).x();
    if (before < 0 && angle >= 0) {
      const double at = 1e-3 * (tick - angle / (angle - before));
      if (crossings++ == 0) first = at;
      last = at;
    }
    before = angle;
  }
  return (last - first) / (crossings - 1);
}

TEST_CASE("A rotational grip swings at its closed-form frequency and keeps its amplitude") {
  SixdofSettings settings = free_body();
  settings.hand = HandModel::spring;
  settings.grip_turning_damping = 0;
  SixdofPlant plant(settings);
  plant.place(Isometry3d(Eigen::AngleAxisd(-0.2, Vector3::UnitX())));
  const double wanted =
      2 * std::numbers::pi * std::sqrt(plant.inertia().x() / settings.grip_turning);
  CHECK(period_of_swing(plant, 3000) == Approx(wanted).epsilon(1e-5));
  double most = 0;
  for (int tick = 0; tick < 200; ++tick) {
    plant.step({}, {});
    most = std::max(most, std::abs(turn_between(Eigen::Quaterniond::Identity(),
                                                Eigen::Quaterniond(plant.pose().linear()))
                                       .x()));
  }
  CHECK(most == Approx(0.2).epsilon(0.01));
}

TEST_CASE("A damped grip and arm lose a displacement as the closed form of two masses says") {
  SixdofSettings settings = free_body();
  settings.hand = HandModel::arm;
  SixdofPlant plant(settings);
  plant.place(Isometry3d::Identity());
  plant.set_motion({0.1, 0, 0}, Vector3::Zero());
  // x' = A x of handle and arm: positions, then velocities.
  const double m = settings.profile.mass, grip = grip_stiffness, damper = grip_damping;
  Eigen::Matrix4d a = Eigen::Matrix4d::Zero();
  a.topRightCorner<2, 2>().setIdentity();
  a.row(2) << -grip / m, grip / m, -damper / m, damper / m;
  a.row(3) << grip / arm_mass, -(grip + arm_stiffness) / arm_mass, damper / arm_mass,
      -(damper + arm_damping) / arm_mass;
  Eigen::Matrix4d substep = Eigen::Matrix4d::Identity(), term = substep;
  for (int power = 1; power < 12; ++power) {
    term = term * a * 1e-3 / power;
    substep += term;
  }
  Eigen::Vector4d state(0, 0, 0.1, 0);
  for (int tick = 0; tick < 300; ++tick) {
    plant.step({}, {});
    state = substep * state;
    REQUIRE(plant.pose().translation().x() == Approx(state[0]).margin(1e-6 * 0.1));
    REQUIRE(plant.velocity().x() == Approx(state[2]).margin(2e-4 * 0.1));
  }
}

TEST_CASE("What the hand and the actuators put in, and what is dissipated, is the kinetic energy") {
  SixdofSettings settings;
  settings.weight = {0, 0, -1};
  for (const HandModel hand : {HandModel::arm, HandModel::spring}) {
    settings.hand = hand;
    SixdofPlant plant(settings);
    plant.place(some_pose());
    double sum = 0, most = 0, dissipated = 0;
    for (int tick = 0; tick < 500; ++tick) {
      const double phase = 0.05 * tick;
      SixdofTarget target;
      target.position = some_pose().translation() + 0.005 * Vector3(std::sin(phase), 0, 0);
      target.velocity = {0.005 * 50 * std::cos(phase), 0, 0};
      const SixdofTick found =
          plant.step({{std::sin(2 * phase), 1, 0}, {0, 0.03 * std::cos(phase), 0.01}}, target);
      sum += found.work + found.hand_work + found.weight_work - found.dissipated;
      dissipated += found.dissipated;
      most = std::max(most, plant.kinetic_energy());
      REQUIRE(sum == Approx(plant.kinetic_energy()).margin(1e-12));
    }
    CHECK(most > 1e-4);
    CHECK(dissipated > 1e-4);
  }
}

TEST_CASE("A command acts the delay after its reading, a fraction of a tick included") {
  for (const double delay : {0.0, 1.0, 2.5}) {
    SixdofSettings settings = free_body();
    settings.delay_ticks = delay;
    SixdofPlant plant(settings);
    plant.place(Isometry3d::Identity());
    for (int tick = 0; tick < 10; ++tick) plant.step({{0.5, 0, 0}, {}}, {});
    const double seconds = 1e-3 * (10 - delay);
    CHECK(plant.velocity().x() == Approx(0.5 * seconds / plant.mass()).epsilon(1e-9));
  }
}

TEST_CASE("Friction holds a tool against less, does no work then, and caps bound what is sent") {
  SixdofSettings settings;
  settings.hand = HandModel::none;
  SixdofPlant plant(settings);
  plant.place(some_pose());
  const double friction = settings.profile.friction;
  for (int tick = 0; tick < 100; ++tick) {
    const SixdofTick found = plant.step({{0.9 * friction, 0, 0}, {0, 0, 0.02 * friction}}, {});
    REQUIRE(found.work == 0);
  }
  CHECK(plant.pose().isApprox(some_pose(), 1e-15));
  const Wrench sent = plant.reachable({{100, 0, 0}, {0, 100, 0}});
  CHECK(sent.force.norm() == Approx(settings.profile.force_cap));
  CHECK(sent.torque.norm() == Approx(plant.torque_cap()));
}

TEST_CASE("The measured pose is within half an encoder step of the true one, and on its grid") {
  SixdofSettings settings = free_body();
  settings.encoder_step = 50e-6;
  SixdofPlant plant(settings);
  plant.place(some_pose());
  plant.set_motion({0.03, 0.02, 0.05}, {1, 2, -1});
  for (int tick = 0; tick < 50; ++tick) {
    plant.step({}, {});
    const Isometry3d measured = plant.measured_pose();
    const Vector3 off = measured.translation() - plant.pose().translation();
    REQUIRE(off.cwiseAbs().maxCoeff() <= 0.5 * settings.encoder_step * (1 + 1e-9));
    const Vector3 turn = turn_between(Eigen::Quaterniond(some_pose().linear()),
                                      Eigen::Quaterniond(measured.linear()));
    const Vector3 steps = turn / plant.turn_step();
    REQUIRE((steps - Vector3(steps.array().round())).norm() < 1e-6);
    const Vector3 error = turn_between(Eigen::Quaterniond(measured.linear()),
                                       Eigen::Quaterniond(plant.pose().linear()));
    REQUIRE(error.norm() < plant.turn_step());
  }
}

}  // namespace
}  // namespace spm::servo::sixdof_plant_test
