// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/sim_dynamics.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace spm::servo;
using spm::Vector3;

namespace {

constexpr double period = 1e-3;
constexpr SimProfile smooth{"smooth", 0.2, 2.0, 0.0, 1e-9, 10, 1e6};

/// Steps with a hand that lets go.
void coast(SimDynamics& tool, int ticks, const Vector3& force) {
  for (int i = 0; i < ticks; ++i) tool.step(force, {}, 0, 0);
}

}  // namespace

TEST_CASE("Without force the speed decays as viscous damping says") {
  SimDynamics tool(smooth, period);
  coast(tool, 100, {1, 0, 0});
  const double before = tool.velocity().x();
  coast(tool, 1, Vector3::Zero());
  coast(tool, 100, Vector3::Zero());
  const double expected = before * std::exp(-smooth.damping / smooth.mass * 0.101);
  REQUIRE(tool.velocity().x() == Approx(expected).epsilon(0.01));
}

TEST_CASE("A constant force accelerates to the terminal speed") {
  SimDynamics tool(smooth, period);
  coast(tool, 3000, {0, 3, 0});
  REQUIRE(tool.velocity().y() == Approx(1.5).epsilon(1e-3));
}

TEST_CASE("A held force and the grip's spring balance") {
  for (const SimProfile& profile : sim_profiles) {
    SimProfile frictionless = profile;
    frictionless.friction = 0;
    SimDynamics tool(frictionless, period);
    tool.place({0.01, 0, 0});
    const HandTarget target{{0.01, 0, 0}, Vector3::Zero()};
    for (int i = 0; i < 3000; ++i) tool.step({0, 0, 1.4}, target);
    REQUIRE((tool.position() - Vector3(0.01, 0, 1.4 / grip_stiffness)).norm() < 1e-6);
  }
}

TEST_CASE("Coulomb friction holds the tool still under a smaller force") {
  SimProfile sticky = smooth;
  sticky.friction = 0.5;
  SimDynamics tool(sticky, period);
  coast(tool, 500, {0.49, 0, 0});
  REQUIRE(tool.position() == Vector3::Zero());
  coast(tool, 500, {0.6, 0, 0});
  REQUIRE(tool.position().x() > 1e-3);
}

TEST_CASE("Coulomb friction stops a coasting tool for good") {
  SimProfile sticky = smooth;
  sticky.friction = 0.5;
  SimDynamics tool(sticky, period);
  coast(tool, 100, {1, 1, 0});
  coast(tool, 2000, Vector3::Zero());
  REQUIRE(tool.velocity() == Vector3::Zero());
}

TEST_CASE("The actuator gives no more than its cap") {
  SimDynamics strong(smooth, period);
  SimDynamics commanded_more(smooth, period);
  coast(strong, 200, {0, 0, smooth.force_cap});
  coast(commanded_more, 200, {0, 0, 5 * smooth.force_cap});
  REQUIRE(commanded_more.position() == strong.position());
}

TEST_CASE("The measured position is a whole number of encoder steps, half a step off at most") {
  for (const SimProfile& profile : sim_profiles) {
    SimDynamics tool(profile, period);
    for (int i = 0; i < 50; ++i) {
      tool.place({i * 1.7e-5, -i * 2.3e-5, i * 3.1e-6});
      const Vector3 measured = tool.measured_position();
      for (int axis = 0; axis < 3; ++axis) {
        const double steps = measured[axis] / profile.encoder_step;
        REQUIRE(std::abs(steps - std::round(steps)) < 1e-6);
        REQUIRE(std::abs(measured[axis] - tool.position()[axis]) <=
                profile.encoder_step / 2 * (1 + 1e-9));
      }
    }
  }
}

TEST_CASE("The profiles have the figures of their devices") {
  REQUIRE(sim_profiles.size() == 5);
  REQUIRE(find_sim_profile("falcon")->force_cap == 8);
  REQUIRE(find_sim_profile("touch")->encoder_step == Approx(55e-6));
  REQUIRE(find_sim_profile("") == nullptr);
}
