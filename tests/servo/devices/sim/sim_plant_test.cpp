// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/sim_plant.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <complex>

namespace sim_plant_test {

using namespace spm::servo;
using spm::Random;
using spm::Vector3;

namespace {

constexpr double period = 1e-3;
constexpr SimProfile smooth{"smooth", 0.2, 2.0, 0.0, 0, 10, 0};

PlantSettings plain(const SimProfile& profile, HandModel hand) {
  PlantSettings settings;
  settings.profile = profile;
  settings.period = period;
  settings.hand = hand;
  return settings;
}

SimPlant free_tool(const SimProfile& profile) { return SimPlant(plain(profile, HandModel::none)); }

void push(SimPlant& plant, int ticks, const Vector3& force) {
  for (int i = 0; i < ticks; ++i) plant.step(force, {});
}

SimProfile rough(double friction) {
  SimProfile profile = smooth;
  profile.friction = friction;
  return profile;
}

}  // namespace

TEST_CASE("A free mass under a constant force moves as the closed form says") {
  SimProfile free = smooth;
  free.damping = 0;
  SimPlant plant = free_tool(free);
  push(plant, 500, {3, -2, 0});
  REQUIRE((plant.velocity() - Vector3(3, -2, 0) * 0.5 / 0.2).norm() < 1e-9);
  REQUIRE((plant.position() - Vector3(3, -2, 0) * 0.5 * 0.5 / 0.4).norm() < 1e-9);
}

TEST_CASE("Without force the speed decays as viscous damping says") {
  SimPlant plant = free_tool(smooth);
  push(plant, 100, {1, 0, 0});
  const double before = plant.velocity().x();
  push(plant, 100, Vector3::Zero());
  const double expected = before * std::exp(-smooth.damping / smooth.mass * 0.1);
  REQUIRE(plant.velocity().x() == Approx(expected).epsilon(1e-6));
}

TEST_CASE("A constant force accelerates to the terminal speed") {
  SimPlant plant = free_tool(smooth);
  push(plant, 3000, {0, 3, 0});
  REQUIRE(plant.velocity().y() == Approx(1.5).epsilon(1e-6));
}

TEST_CASE("In a resting grip the tool is the damped oscillator of the closed form") {
  for (const SimProfile& profile : sim_profiles) {
    SimProfile frictionless = profile;
    frictionless.friction = 0;
    SimPlant plant(plain(frictionless, HandModel::spring));
    plant.place({1e-3, 0, 0});
    const std::complex<double> half((profile.damping + grip_damping) / (2 * profile.mass), 0);
    const std::complex<double> swing =
        std::sqrt(half * half - std::complex<double>(grip_stiffness / profile.mass, 0));
    for (int tick = 1; tick <= 300; ++tick) {
      plant.step(Vector3::Zero(), {});
      const double time = tick * period;
      const std::complex<double> expected =
          1e-3 * std::exp(-half * time) *
          (std::cosh(swing * time) + half / swing * std::sinh(swing * time));
      REQUIRE(plant.position().x() == Approx(expected.real()).margin(1e-3 * 2e-4));
    }
  }
}

TEST_CASE("A held force and the hand's springs balance") {
  for (const SimProfile& profile : sim_profiles) {
    for (const HandModel hand : {HandModel::spring, HandModel::arm}) {
      SimProfile frictionless = profile;
      frictionless.friction = 0;
      SimPlant plant(plain(frictionless, hand));
      plant.place({0.01, 0, 0});
      const HandTarget target{{0.01, 0, 0}, Vector3::Zero()};
      PlantTick tick;
      for (int i = 0; i < 6000; ++i) tick = plant.step({0, 0, 0.7}, target);
      const double give = 1 / grip_stiffness + (hand == HandModel::arm ? 1 / arm_stiffness : 0);
      REQUIRE((plant.position() - Vector3(0.01, 0, 0.7 * give)).norm() < 1e-7);
      REQUIRE((tick.hand_force - Vector3(0, 0, -0.7)).norm() < 1e-5);
      REQUIRE((tick.actuator_force - Vector3(0, 0, 0.7)).norm() < 1e-9);
    }
  }
}

TEST_CASE("A tool follows a target that moves on evenly, in a spring's grip and in an arm's") {
  for (const HandModel hand : {HandModel::spring, HandModel::arm}) {
    SimProfile free = smooth;
    free.damping = 0;
    SimPlant plant(plain(free, hand));
    const Vector3 speed(0.05, 0, 0.02);
    for (int tick = 1; tick <= 4000; ++tick) {
      plant.step(Vector3::Zero(), {tick * period * speed, speed});
    }
    REQUIRE((plant.velocity() - speed).norm() < 1e-6);
    REQUIRE((plant.position() - 4 * speed).norm() < 1e-6);
  }
}

TEST_CASE("A tool at rest stays until the force exceeds Coulomb friction") {
  for (const double friction : {0.02, 0.5}) {
    SimPlant plant = free_tool(rough(friction));
    push(plant, 500, 0.9999 * friction * Vector3(0.6, 0.8, 0));
    REQUIRE(plant.position() == Vector3::Zero());
    push(plant, 500, 1.01 * friction * Vector3(0.6, 0.8, 0));
    REQUIRE(plant.position().norm() > 0);
    REQUIRE(plant.velocity().normalized().dot(Vector3(0.6, 0.8, 0)) == Approx(1));
  }
}

TEST_CASE("Coulomb friction stops a coasting tool for good, after the way of the closed form") {
  SimProfile profile = rough(0.5);
  profile.damping = 0;
  SimPlant plant = free_tool(profile);
  push(plant, 100, {1, 1, 0});
  const Vector3 begin = plant.position();
  const double speed = plant.velocity().norm();
  push(plant, 2000, Vector3::Zero());
  REQUIRE(plant.velocity() == Vector3::Zero());
  const double way = speed * speed * profile.mass / (2 * profile.friction);
  REQUIRE((plant.position() - begin).norm() == Approx(way).epsilon(1e-4));
}

TEST_CASE("Friction holds a tool of any pose-dependent mass, and slows it along its way") {
  PlantSettings settings = plain(rough(0.3), HandModel::none);
  settings.mass = MovingMass::falcon;
  settings.profile.damping = 0;
  SimPlant plant(settings);
  plant.place({0.01, -0.02, 0.005});
  push(plant, 200, {0.2, 0.1, -0.1});
  REQUIRE(plant.velocity() == Vector3::Zero());
  double losses = 0, works = 0;
  for (int i = 0; i < 20; ++i) {
    const PlantTick tick = plant.step({2, 1, -1}, {});
    losses += tick.loss;
    works += tick.work;
  }
  const double way = (plant.position() - Vector3(0.01, -0.02, 0.005)).norm();
  REQUIRE(losses == Approx(0.3 * way).epsilon(0.01));
  REQUIRE(works - losses == Approx(plant.energy().tool).epsilon(0.02));
}

TEST_CASE("A friction scale of 0 makes a device without Coulomb friction") {
  PlantSettings settings = plain(rough(0.5), HandModel::none);
  settings.friction_scale = 0;
  SimPlant plant(settings);
  push(plant, 100, {0.01, 0, 0});
  REQUIRE(plant.velocity().x() > 1e-4);
}

TEST_CASE("The actuator gives no more than its cap") {
  SimPlant strong = free_tool(smooth);
  SimPlant commanded_more = free_tool(smooth);
  push(strong, 200, {0, 0, smooth.force_cap});
  push(commanded_more, 200, {0, 0, 5 * smooth.force_cap});
  REQUIRE(commanded_more.position() == strong.position());
}

TEST_CASE("A late force moves the tool as many ticks later as its delay says") {
  for (const double delay : {1.0, 2.0, 1.37, 4.5}) {
    SimProfile free = smooth;
    free.damping = 0;
    PlantSettings settings = plain(free, HandModel::none);
    settings.delay_ticks = delay;
    SimPlant plant(settings);
    push(plant, 100, {1, 0, 0});
    const double time = (100 - delay) * period;
    REQUIRE(plant.velocity().x() == Approx(time / 0.2).epsilon(1e-9));
    REQUIRE(plant.position().x() == Approx(time * time / 0.4).epsilon(1e-5));
  }
}

TEST_CASE("The measured position is a whole number of encoder steps, half a step off at most") {
  for (const SimProfile& profile : sim_profiles) {
    SimPlant plant(plain(profile, HandModel::spring));
    for (int i = 0; i < 50; ++i) {
      plant.place({i * 1.7e-5, -i * 2.3e-5, i * 3.1e-6});
      const Vector3 measured = plant.measured_position();
      for (int axis = 0; axis < 3; ++axis) {
        const double steps = measured[axis] / profile.encoder_step;
        REQUIRE(std::abs(steps - std::round(steps)) < 1e-6);
        REQUIRE(std::abs(measured[axis] - plant.position()[axis]) <=
                profile.encoder_step / 2 * (1 + 1e-9));
      }
    }
  }
}

TEST_CASE(
    "A reading without encoder steps and noise is the true position, and noise is as settings "
    "say") {
  PlantSettings settings = plain(smooth, HandModel::none);
  settings.encoder_step = 0;
  SimPlant clear(settings);
  push(clear, 50, {1, 0, 0});
  REQUIRE(clear.measured_position() == clear.position());
  settings.noise = 5e-6;
  SimPlant noisy(settings);
  Vector3 sum = Vector3::Zero(), squares = Vector3::Zero();
  constexpr int ticks = 20000;
  for (int i = 0; i < ticks; ++i) {
    noisy.step(Vector3::Zero(), {});
    const Vector3 off = noisy.measured_position() - noisy.position();
    REQUIRE(off == noisy.measured_position() - noisy.position());
    sum += off;
    squares += off.cwiseAbs2();
  }
  for (int axis = 0; axis < 3; ++axis) {
    REQUIRE(std::abs(sum[axis] / ticks) < 4 * 5e-6 / std::sqrt(ticks));
    REQUIRE(std::sqrt(squares[axis] / ticks) == Approx(5e-6).epsilon(0.03));
  }
}

TEST_CASE("Energy stored is work done less losses, to a millionth, with friction, lag and delay") {
  for (const SimProfile& profile : sim_profiles) {
    for (const HandModel hand : {HandModel::spring, HandModel::arm, HandModel::none}) {
      for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        PlantSettings settings = plain(profile, hand);
        settings.delay_ticks = 1.3;
        settings.seed = seed;
        SimPlant plant(settings);
        Random random(seed);
        HandTarget target;
        double turned_over = 0, put_in = 0, tool_work = 0, losses = 0;
        for (int i = 0; i < 400; ++i) {
          target.velocity = 0.2 * random.direction();
          target.position += target.velocity * period;
          const PlantTick tick = plant.step(2 * random.direction(), target);
          REQUIRE(tick.loss >= -1e-9);
          REQUIRE(tick.hand_loss >= 0);
          put_in += tick.work + tick.target_work - tick.loss - tick.hand_loss;
          tool_work += tick.work + tick.hand_work - tick.loss;
          losses += tick.loss + tick.hand_loss;
          turned_over += std::abs(tick.work) + std::abs(tick.target_work);
        }
        // From what is seen from outside, not from the plant's own books.
        const double tool = profile.mass * plant.velocity().squaredNorm() / 2;
        double stored = tool;
        if (hand == HandModel::spring) {
          stored += grip_stiffness * (target.position - plant.position()).squaredNorm() / 2;
        }
        if (hand == HandModel::arm) {
          stored += grip_stiffness * (plant.arm_position() - plant.position()).squaredNorm() / 2 +
                    arm_stiffness * (target.position - plant.arm_position()).squaredNorm() / 2 +
                    arm_mass * plant.arm_velocity().squaredNorm() / 2;
        }
        REQUIRE(losses > 0);
        REQUIRE(tool_work == Approx(tool).margin(1e-6 * turned_over));
        REQUIRE(put_in == Approx(stored).margin(1e-6 * turned_over));
        REQUIRE(plant.energy().tool + plant.energy().hand == Approx(stored).epsilon(1e-9));
      }
    }
  }
}

TEST_CASE("More substeps change next to nothing: 20 are enough, friction and lag included") {
  for (const SimProfile& profile : sim_profiles) {
    PlantSettings settings = plain(profile, HandModel::arm);
    settings.delay_ticks = 1;
    SimPlant coarse(settings);
    settings.substeps = 400;
    SimPlant fine(settings);
    double furthest = 0;
    for (int i = 0; i < 500; ++i) {
      const double swing = std::sin(0.05 * i);
      const HandTarget target{{0.01 * swing, 0, 0}, {0.5 * std::cos(0.05 * i), 0, 0}};
      coarse.step({-1.5 * swing, 0, 0}, target);
      fine.step({-1.5 * swing, 0, 0}, target);
      furthest = std::max(furthest, (coarse.position() - fine.position()).norm());
    }
    REQUIRE(furthest < 5e-6);
  }
}

TEST_CASE("A carried tool is where it is taken, and the hand's work is what the rest is not") {
  PlantSettings settings = plain(rough(0.4), HandModel::none);
  settings.encoder_step = 0;
  SimPlant plant(settings);
  double hand_work = 0, wall_work = 0, way = 0, viscous = 0;
  Vector3 to = Vector3::Zero();
  for (int i = 0; i < 1000; ++i) {
    to = {1e-3 * std::sin(0.02 * i), 0, 0};
    const Vector3 before = plant.position();
    const Vector3 force = -500 * plant.measured_position();
    const PlantTick tick = plant.carry(force, to);
    REQUIRE(plant.measured_position() == to);
    hand_work += tick.hand_work;
    wall_work += force.dot(to - before);
    way += (to - before).norm();
    viscous += smooth.damping * (to - before).squaredNorm() / period;
  }
  const double kinetic = smooth.mass * plant.velocity().squaredNorm() / 2;
  REQUIRE(hand_work == Approx(kinetic + viscous + 0.4 * way - wall_work).epsilon(1e-9));
}

TEST_CASE("The same settings give the same ticks, and a place begins them anew") {
  PlantSettings settings = plain(sim_profiles[1], HandModel::arm);
  settings.delay_ticks = 1.2;
  settings.mass = MovingMass::falcon;
  SimPlant first(settings), second(settings);
  first.place({1e-3, 0, 0});
  second.place({1e-3, 0, 0});
  for (int i = 0; i < 200; ++i) {
    first.step({0.5, 0.1 * i, 0}, {});
    second.step({0.5, 0.1 * i, 0}, {});
    REQUIRE(first.position() == second.position());
  }
  second.place({1e-3, 0, 0});
  REQUIRE(second.velocity() == Vector3::Zero());
  REQUIRE(second.energy().tool == 0);
  REQUIRE(second.energy().hand == 0);
  const PlantTick tick = second.step(Vector3::Zero(), {{1e-3, 0, 0}, Vector3::Zero()});
  REQUIRE(tick.actuator_force == Vector3::Zero());
  REQUIRE(second.position() == Vector3(1e-3, 0, 0));
}

TEST_CASE("A longer tick has more substeps") {
  REQUIRE(substeps_for(1e-3) == 20);
  REQUIRE(substeps_for(0.25e-3) == 20);
  REQUIRE(substeps_for(2e-3) == 40);
}

TEST_CASE("The profiles have the figures of their devices") {
  REQUIRE(sim_profiles.size() == 5);
  REQUIRE(find_sim_profile("falcon")->force_cap == 8);
  REQUIRE(find_sim_profile("touch")->encoder_step == Approx(55e-6));
  REQUIRE(find_sim_profile("") == nullptr);
}

}  // namespace sim_plant_test
