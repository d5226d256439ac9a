// SPDX-License-Identifier: Apache-2.0
#include "servo/stabilize/stabilizer.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>
#include <utility>
#include <vector>

#include "common/contact/stable_stiffness.hpp"
#include "servo/force/scene_force.hpp"
#include "tests/support/asset_by_hand.hpp"

namespace spm::stabilizer_test {
namespace {

constexpr double tick = 1e-3;

/// A wall at z = 0 that pushes up with a stiffness, N/m.
ContactForce wall(const Vector3& hand, double stiffness) {
  ContactForce contact;
  if (!(hand.z() < 0)) return contact;
  contact.contact = true;
  contact.depth = -hand.z();
  contact.normal = Vector3::UnitZ();
  contact.force = stiffness * contact.depth * contact.normal;
  return contact;
}

/// A hand presses gently and lets go: smoothly, at most at `speed`, with a rest between.
std::vector<double> gentle_press(double depth, double speed) {
  std::vector<double> way;
  const double top = 3e-4;
  const int ticks = static_cast<int>((depth + top) * std::numbers::pi / (2 * speed * tick));
  const auto height = [&](int i) {
    return top - (depth + top) * (1 - std::cos(std::numbers::pi * i / ticks)) / 2;
  };
  for (int i = 0; i <= ticks; ++i) way.push_back(height(i));
  for (int i = 0; i < 200; ++i) way.push_back(way.back());
  for (int i = ticks; i >= 0; --i) way.push_back(height(i));
  return way;
}

/// The energy that a wall can give back when it is asked to push with a stiffness.
ContactEnergy energy_of(const ContactForce& wanted, double stiffness) {
  return {stiffness, wanted.force.squaredNorm() / (2 * stiffness), 0};
}

double counted(double position, double step) {
  return step > 0 ? step * std::round(position / step) : position;
}

/// The largest change of what the stabilizers add to a wall's force from tick to tick, N.
double added_step(const StabilizationSettings& settings, const std::vector<double>& way,
                  double stiffness, double encoder_step) {
  Stabilizer stabilization(settings, tick, encoder_step);
  double largest = 0, last = 0;
  for (const double z : way) {
    const Vector3 hand(0, 0, counted(z, encoder_step));
    const ContactForce wanted = wall(hand, stiffness);
    const double added = stabilization.apply(wanted, hand, energy_of(wanted, stiffness)).force.z() -
                         wanted.force.z();
    largest = std::max(largest, std::abs(added - last));
    last = added;
  }
  return largest;
}

TEST_CASE(
    "Matched damping is a share of K (1/2 + d + lag/T) T against the motion along the force") {
  CHECK(matched_damping(1, 1000, 0, tick) == Approx(0.5));
  CHECK(matched_damping(0.8, 1000, 1, tick) == Approx(1.2));
  CHECK(matched_damping(0.8, 2000, 2.5, 2 * tick) == Approx(9.6));
  StabilizationSettings settings;
  settings.damping_share = 0.8;
  settings.delay_ticks = 1.5;
  settings.lag = 0.5 * tick;
  Stabilizer stabilization(settings, tick, 0);
  for (int i = 0; i < 100; ++i) {
    const Vector3 hand(1e-5 * i, 0, -1e-3 - 3e-6 * i);
    const ContactForce wanted = wall(hand, 1500);
    const Vector3 added =
        stabilization.apply(wanted, hand, energy_of(wanted, 1500)).force - wanted.force;
    if (i == 0) continue;
    CHECK(added.x() == 0);  // a hand that slides is not held
    CHECK(added.z() == Approx(0.8 * 1500 * 2.5e-3 * 0.003));
  }
}

TEST_CASE("With coarse encoders damping is complete only from some steps of the spring on") {
  StabilizationSettings settings;
  settings.damping_share = 1;
  settings.delay_ticks = 0;
  settings.lag = 0;
  constexpr double step = 1e-4, stiffness = 1000;
  // Of fine ones from 0.2 N on, of these from 0.6 N.
  for (const auto& [encoder, full_from] : {std::pair{0.0, 0.2}, {step, 0.6}}) {
    for (const double reaction : {0.15, 0.3, 1.0}) {
      CAPTURE(encoder, reaction);
      Stabilizer stabilization(settings, tick, encoder);
      ContactForce wanted;
      wanted.contact = true;
      wanted.force = {0, 0, reaction};
      double added = 0;
      for (int i = 0; i < 200; ++i) {
        added =
            stabilization.apply(wanted, {0, 0, -step * i}, {stiffness, 0, 0}).force.z() - reaction;
      }
      // 0.1 m/s against K T / 2.
      const double all = 0.1 * stiffness * tick / 2;
      CHECK(added == Approx(all * std::min(1.0, reaction / full_from)).epsilon(0.02));
    }
  }
}

TEST_CASE("Damping is bounded by the device's mass, and by the reaction, and never holds back") {
  StabilizationSettings settings;
  settings.damping_share = 2;
  settings.device_mass = 0.05;
  CHECK(max_damping(0.05, tick) == Approx(12.5));
  CHECK(max_damping(0.05, tick, 0) == Approx(12.5));
  CHECK(max_damping(0.05, tick, 4.5) == Approx(6));
  for (const double stiffness : {500.0, 5000.0, 1e6}) {
    Stabilizer stabilization(settings, tick, 0);
    for (int i = 0; i < 200; ++i) {
      const Vector3 hand(0, 0, -2e-3 * std::sin(0.1 * i));
      const ContactForce wanted = wall(hand, stiffness);
      const ContactForce stabilized =
          stabilization.apply(wanted, hand, energy_of(wanted, stiffness));
      CHECK(stabilized.force.z() >= -1e-12);
      CHECK((stabilized.force - wanted.force).norm() <= wanted.force.norm() * (1 + 1e-12));
      CHECK((stabilized.force - wanted.force).norm() <= 12.5 * 0.21);
    }
  }
  CHECK(within_reaction({0, 0, 1}, 0).isZero());
  CHECK(within_reaction({0, 0, 1}, full_braking_reaction / 2).z() ==
        Approx(full_braking_reaction / 2));
  CHECK(within_reaction({0, 0, 0.01}, full_braking_reaction / 2).z() == Approx(0.005));
  CHECK(within_reaction({0, 0, 1}, 5).z() == 1);
}

TEST_CASE("On a gentle press idle stabilizers add less than 0.03 N from tick to tick") {
  for (const std::string_view words : {"damping", "passivity", "damping+passivity"}) {
    StabilizationSettings settings;
    REQUIRE(parse_stabilization(words, settings));
    for (const DeviceProfile& device : device_profiles) {
      CAPTURE(words, device.name);
      settings.device_mass = device.moving_mass;
      CHECK(added_step(settings, gentle_press(1e-3, 0.02), 1000, device.encoder_step) < 0.03);
    }
  }
}

TEST_CASE("A word sets its stabilizer alone, and an unknown one nothing") {
  StabilizationSettings stabilization;
  CHECK(parse_stabilization("", stabilization));
  for (const char* wrong : {"damping+", "+", "+damping", "damping++passivity"}) {
    CAPTURE(wrong);
    CHECK_FALSE(parse_stabilization(wrong, stabilization));
  }
  CHECK_FALSE(stabilization.any());
  CHECK(parse_stabilization("damping+passivity", stabilization));
  CHECK(stabilization.damping_share == recommended_damping_share);
  CHECK(stabilization.passivity);
  CHECK(stabilization.coupling == 0);
  CHECK(parse_stabilization("coupling+potential+difference", stabilization));
  CHECK(stabilization.coupling > 0);
  CHECK(stabilization.potential > 0);
  CHECK(stabilization.velocity == VelocityMethod::difference);
  CHECK(parse_stabilization("velocity", stabilization));
  CHECK(stabilization.velocity == VelocityMethod::estimate);
  const StabilizationSettings before = stabilization;
  for (const std::string_view wrong :
       {"dampng", "damping+", "+damping", "damping,passivity", "+"}) {
    CAPTURE(wrong);
    CHECK_FALSE(parse_stabilization(wrong, stabilization));
    CHECK(stabilization == before);
  }
  stabilization.device_mass = 0.3;
  stabilization.lag = 1e-3;
  CHECK(parse_stabilization("recommended", stabilization));
  StabilizationSettings wanted = recommended_stabilization;
  wanted.device_mass = 0.3;
  wanted.lag = 1e-3;
  CHECK(stabilization == wanted);
}

TEST_CASE("Chosen stabilizers keep the delay, lag and mass of the loop they are for") {
  StabilizationSettings loop;
  loop.passivity = true;
  loop.delay_ticks = 2.5;
  loop.lag = 2e-3;
  loop.device_mass = 0.4;
  StabilizationSettings wanted = recommended_stabilization;
  wanted.delay_ticks = 2.5;
  wanted.lag = 2e-3;
  wanted.device_mass = 0.4;
  CHECK(in_loop_of(loop, recommended_stabilization) == wanted);
  const StabilizationSettings touch = in_loop_of(device_profiles[2], loop);
  CHECK(touch.delay_ticks == 2.5);
  CHECK(touch.passivity);
  CHECK(touch.device_mass == device_profiles[2].moving_mass);
  CHECK(touch.lag == device_profiles[2].actuator_lag());
}

TEST_CASE("Stiffness by the device is a share of its border and within its rating") {
  for (const DeviceProfile& device : device_profiles) {
    const double chosen = stable_stiffness(device);
    CHECK(chosen > 0);
    CHECK(chosen <= device.stiffness_cap);
  }
  CHECK(stable_stiffness(*find_device_profile("touch")) == 400);
  CHECK(stable_stiffness(*find_device_profile("low")) ==
        Approx(stiffness_margin * std::min(stiffness_borders[0].hold, stiffness_borders[0].tap)));
}

TEST_CASE("Without stabilizers every force comes back to the bit") {
  const StabilizationSettings none;
  Stabilizer stabilization(none, tick, 20e-6);
  for (int i = 0; i < 50; ++i) {
    const Vector3 hand(1e-4 * i, 0, -1e-5 * i);
    const ContactForce wanted = wall(hand, 1234.5);
    CHECK(stabilization.apply(wanted, hand, energy_of(wanted, 1234.5)).force == wanted.force);
  }
}

TEST_CASE("Positions and forces that are no numbers give no force, and are forgotten") {
  const StabilizationSettings all = recommended_stabilization;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinite = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinite, -infinite, 1e308}) {
    Stabilizer stabilization(all, tick, 20e-6);
    const Vector3 hand(0, 0, -1e-3);
    const ContactForce right = wall(hand, 1000);
    const ContactEnergy energy = energy_of(right, 1000);
    const auto after = [&] { return stabilization.apply(right, hand, energy).force; };
    for (int i = 0; i < 5; ++i) (void)after();
    CHECK(stabilization.apply(right, {bad, 0, -1e-3}, energy).force.allFinite());
    ContactForce wrong = right;
    wrong.force.x() = bad;
    CHECK(stabilization.apply(wrong, hand, energy).force.allFinite());
    CHECK(stabilization.apply(wrong, {0, 0, bad}, energy).force.allFinite());
    for (int i = 0; i < 40; ++i) CHECK(after().allFinite());
    if (std::isfinite(bad)) continue;  // a way that long is a motion
    CHECK(after().z() == Approx(1));
  }
}

}  // namespace
}  // namespace spm::stabilizer_test
