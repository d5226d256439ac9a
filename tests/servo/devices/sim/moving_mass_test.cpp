// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/moving_mass.hpp"

#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>

#include "common/base/random.hpp"
#include "servo/devices/sim/sim_plant.hpp"

namespace moving_mass_test {

using namespace spm::servo;
using spm::Random;
using spm::Vector3;

namespace {

double mass_of(MovingMass kind) {
  return find_sim_profile(kind == MovingMass::falcon ? "falcon" : "wooden")->mass;
}

}  // namespace

TEST_CASE("The moving mass is symmetric, positive definite and of a sound size in every pose") {
  const MovingMass kind = GENERATE(MovingMass::falcon, MovingMass::serial_arm);
  const double mass = mass_of(kind);
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    Random random(seed);
    const Vector3 position = random.between(0, 0.3) * random.direction();
    CAPTURE(seed, position.transpose());
    const Eigen::Matrix3d moving = mass_at(kind, mass, position);
    REQUIRE(moving == moving.transpose());
    const Vector3 principal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moving).eigenvalues();
    REQUIRE(principal.minCoeff() > 0.2 * mass);
    REQUIRE(principal.maxCoeff() < 4 * mass);
  }
}

TEST_CASE("At the centre the mean mass is the profile's, and it does depend on the pose") {
  const MovingMass kind = GENERATE(MovingMass::falcon, MovingMass::serial_arm);
  const double mass = mass_of(kind);
  REQUIRE(mass_at(kind, mass, Vector3::Zero()).trace() / 3 == Approx(mass).epsilon(1e-9));
  double least = mass, most = mass;
  for (const double x : {-0.03, 0.0, 0.03}) {
    for (const double z : {-0.03, 0.0, 0.03}) {
      const double mean = mass_at(kind, mass, {x, 0, z}).trace() / 3;
      least = std::min(least, mean);
      most = std::max(most, mean);
    }
  }
  REQUIRE(most > 1.02 * least);
}

TEST_CASE("The moving mass changes without a jump, also at the edge of its reach") {
  const MovingMass kind = GENERATE(MovingMass::falcon, MovingMass::serial_arm);
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    Random random(seed);
    const Vector3 direction = random.direction();
    Eigen::Matrix3d last = mass_at(kind, 0.25, Vector3::Zero());
    for (double distance = 0; distance < 0.2; distance += 5e-4) {
      const Eigen::Matrix3d now = mass_at(kind, 0.25, distance * direction);
      REQUIRE((now - last).norm() < 0.02);
      last = now;
    }
  }
}

TEST_CASE("A mass that is the same everywhere has no gyroscopic force") {
  REQUIRE(mass_at(MovingMass::constant, 0.3, {0.01, 0.02, 0.03}) ==
          0.3 * Eigen::Matrix3d::Identity());
  REQUIRE(gyroscopic_force(MovingMass::constant, 0.3, {0.01, 0, 0}, {1, 2, 3}) == Vector3::Zero());
}

TEST_CASE("The gyroscopic force takes half of what the mass's change gives, and keeps the energy") {
  const MovingMass kind = GENERATE(MovingMass::falcon, MovingMass::serial_arm);
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Random random(seed);
    const Vector3 position = random.between(0, 0.03) * random.direction();
    const Vector3 velocity = random.between(0.05, 0.5) * random.direction();
    const double ahead = 1e-4;  // m
    const Vector3 step = ahead * velocity.normalized();
    const Eigen::Matrix3d change =
        mass_at(kind, 0.25, position + step) - mass_at(kind, 0.25, position - step);
    const double rate = velocity.norm() / (2 * ahead) * velocity.dot(change * velocity);
    const double power = gyroscopic_force(kind, 0.25, position, velocity).dot(velocity);
    REQUIRE(power == Approx(-rate / 2).epsilon(0.01).margin(1e-5));
  }
}

TEST_CASE("A tool with a pose-dependent mass that coasts keeps its energy to 1 %") {
  const MovingMass kind = GENERATE(MovingMass::falcon, MovingMass::serial_arm);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    PlantSettings settings;
    settings.profile = {"smooth", mass_of(kind), 0, 0, 0, 100, 0};
    settings.hand = HandModel::none;
    settings.mass = kind;
    SimPlant plant(settings);
    const Vector3 direction = random.direction();
    plant.place(-0.03 * direction);
    for (int i = 0; i < 10; ++i) plant.step(10 * direction, {});
    plant.step(Vector3::Zero(), {});
    const double before = plant.energy().tool;
    REQUIRE(before > 1e-3);
    while (plant.position().norm() < 0.03) plant.step(Vector3::Zero(), {});
    CAPTURE(kind, seed);
    REQUIRE(plant.energy().tool == Approx(before).epsilon(0.01));
  }
}

}  // namespace moving_mass_test
