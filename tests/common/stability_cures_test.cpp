// SPDX-License-Identifier: Apache-2.0
#include "common/stability_cures.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>
#include <vector>

#include "asset_by_hand.hpp"
#include "common/scene_force.hpp"
#include "common/stable_stiffness.hpp"

namespace spm {
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

/// A hand that goes down to a depth at a speed, rests and goes up again: z of each tick, m.
std::vector<double> press(double depth, double speed) {
  std::vector<double> way;
  const int ticks = static_cast<int>(depth / (speed * tick));
  for (int i = -20; i <= ticks; ++i) way.push_back(-speed * tick * i - 1e-5);
  for (int i = 0; i < 100; ++i) way.push_back(way.back());
  for (int i = 0; i < ticks + 20; ++i) way.push_back(way.back() + speed * tick);
  return way;
}

/// As a hand presses gently and lets go: smoothly, at most so fast, with a rest between.
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

double counted(double position, double step) {
  return step > 0 ? step * std::round(position / step) : position;
}

/// The largest change of what the cures add to a wall's force from tick to tick, N.
double added_step(const CureSettings& settings, const std::vector<double>& way, double stiffness,
                  double encoder_step) {
  StabilityCures cures(settings, tick, encoder_step, stiffness);
  double largest = 0, last = 0;
  for (const double z : way) {
    const Vector3 hand(0, 0, counted(z, encoder_step));
    const ContactForce wanted = wall(hand, stiffness);
    const double added = cures.apply(wanted, hand).force.z() - wanted.force.z();
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
  CureSettings settings;
  settings.damping_share = 0.8;
  settings.delay_ticks = 1.5;
  settings.lag = 0.5 * tick;
  StabilityCures cures(settings, tick, 0, 1500);
  for (int i = 0; i < 100; ++i) {
    const Vector3 hand(1e-5 * i, 0, -1e-3 - 3e-6 * i);
    const ContactForce wanted = wall(hand, 1500);
    const Vector3 added = cures.apply(wanted, hand).force - wanted.force;
    if (i == 0) continue;
    CHECK(added.x() == 0);  // a hand that slides is not held
    CHECK(added.z() == Approx(0.8 * 1500 * 2.5e-3 * 0.003));
  }
}

TEST_CASE("Damping is bounded by the device's mass, and by the reaction, and never holds back") {
  CureSettings settings;
  settings.damping_share = 2;
  settings.device_mass = 0.05;
  CHECK(most_damping(0.05, tick) == Approx(12.5));
  CHECK(most_damping(0.05, tick, 0) == Approx(12.5));
  CHECK(most_damping(0.05, tick, 4.5) == Approx(6));
  for (const double stiffness : {500.0, 5000.0, 1e6}) {
    StabilityCures cures(settings, tick, 0, stiffness);
    for (int i = 0; i < 200; ++i) {
      const Vector3 hand(0, 0, -2e-3 * std::sin(0.1 * i));
      const ContactForce wanted = wall(hand, stiffness);
      const ContactForce cured = cures.apply(wanted, hand);
      CHECK(cured.force.z() >= -1e-12);
      CHECK((cured.force - wanted.force).norm() <= wanted.force.norm() * (1 + 1e-12));
      CHECK((cured.force - wanted.force).norm() <= 12.5 * 0.21);
    }
  }
  CHECK(within_reaction({0, 0, 1}, 0).isZero());
  CHECK(within_reaction({0, 0, 1}, whole_braking_from / 2).z() == Approx(whole_braking_from / 2));
  CHECK(within_reaction({0, 0, 0.01}, whole_braking_from / 2).z() == Approx(0.005));
  CHECK(within_reaction({0, 0, 1}, 5).z() == 1);
}

TEST_CASE("On a gentle press idle cures add less than 0.03 N from tick to tick") {
  for (const std::string_view words :
       {"damping", "passivity", "coupling", "damping+passivity", "damping+coupling+passivity"}) {
    CureSettings settings;
    REQUIRE(parse_cures(words, settings));
    for (const DeviceProfile& device : device_profiles) {
      CAPTURE(words, device.name);
      settings.device_mass = device.moving_mass;
      CHECK(added_step(settings, gentle_press(1e-3, 0.02), 1000, device.encoder_step) < 0.03);
    }
  }
}

TEST_CASE("What a coupling makes of a spring is the two in series, up to what may be felt") {
  CHECK(felt_stiffness(1000, 0) == 1000);
  CHECK(felt_stiffness(1000, 3000) == 1000);
  CHECK(felt_stiffness(1000, 1000) == Approx(800));
  CureSettings settings;
  for (const double stiff : {400.0, 1000.0, 3000.0}) {
    settings.coupling = stiff;
    StabilityCures cures(settings, tick, 0, 1000);
    const Vector3 hand(0, 0, -1e-3);
    CHECK(cures.apply(wall(hand, 1000), hand).force.z() ==
          Approx(1e-3 * felt_stiffness(1000, stiff)));
  }
}

TEST_CASE("A coupling's damper pushes back while it is pressed, is quiet at rest, never pulls") {
  CureSettings settings;
  settings.coupling = 3000;
  settings.coupling_damping = 2;
  StabilityCures cures(settings, tick, 0, 1000);
  double pressing = 0, leaving = 0, resting = 0;
  const std::vector<double> way = press(2e-3, 0.02);
  for (std::size_t i = 0; i < way.size(); ++i) {
    const Vector3 hand(0, 0, way[i]);
    const ContactForce wanted = wall(hand, 1000);
    const ContactForce cured = cures.apply(wanted, hand);
    CHECK(cured.force.z() >= 0);
    const double added = cured.force.z() - wanted.force.z();
    if (i == 100) pressing = added;
    if (i == 215) resting = added;
    if (i == 270) leaving = added;
  }
  // At a steady speed the damper b beside K_c before K_s makes b v (K_s / (K_c + K_s))^2.
  CHECK(pressing == Approx(2 * 0.02 / 9).epsilon(0.02));
  CHECK(leaving == Approx(-2 * 0.02 / 9).epsilon(0.02));
  CHECK(resting == Approx(0).margin(1e-6));
}

TEST_CASE("A word sets its cure alone, and an unknown one nothing") {
  CureSettings cures;
  CHECK(parse_cures("", cures));
  CHECK_FALSE(cures.any());
  CHECK(parse_cures("damping+passivity", cures));
  CHECK(cures.damping_share == advised_damping_share);
  CHECK(cures.passivity);
  CHECK(cures.coupling == 0);
  CHECK(parse_cures("coupling+potential+difference", cures));
  CHECK(cures.coupling > 0);
  CHECK(cures.potential > 0);
  CHECK(cures.velocity == VelocityBy::difference);
  CHECK(parse_cures("velocity", cures));
  CHECK(cures.velocity == VelocityBy::estimate);
  const CureSettings before = cures;
  for (const std::string_view wrong :
       {"dampng", "damping+", "+damping", "damping,passivity", "+"}) {
    CAPTURE(wrong);
    CHECK_FALSE(parse_cures(wrong, cures));
    CHECK(cures == before);
  }
  cures.device_mass = 0.3;
  cures.lag = 1e-3;
  CHECK(parse_cures("default", cures));
  CureSettings wanted = advised_cures;
  wanted.device_mass = 0.3;
  wanted.lag = 1e-3;
  CHECK(cures == wanted);
  CHECK(default_cures(device_profiles[2]).device_mass == device_profiles[2].moving_mass);
  CHECK(default_cures(device_profiles[2]).lag == device_profiles[2].actuator_lag());
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

TEST_CASE("Without cures every force comes back to the bit") {
  const CureSettings none;
  StabilityCures cures(none, tick, 20e-6, 1000);
  for (int i = 0; i < 50; ++i) {
    const Vector3 hand(1e-4 * i, 0, -1e-5 * i);
    const ContactForce wanted = wall(hand, 1234.5);
    CHECK(cures.apply(wanted, hand).force == wanted.force);
  }
}

TEST_CASE("Positions and forces that are no numbers give no force, and are forgotten") {
  CureSettings all;
  REQUIRE(parse_cures("damping+coupling+passivity", all));
  all.coupling_damping = 1;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinite = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinite, -infinite, 1e308}) {
    StabilityCures cures(all, tick, 20e-6, 1000);
    const Vector3 hand(0, 0, -1e-3);
    for (int i = 0; i < 5; ++i) (void)cures.apply(wall(hand, 1000), hand);
    CHECK(cures.apply(wall(hand, 1000), {bad, 0, -1e-3}).force.allFinite());
    ContactForce wrong = wall(hand, 1000);
    wrong.force.x() = bad;
    CHECK(cures.apply(wrong, hand).force.allFinite());
    CHECK(cures.apply(wrong, {0, 0, bad}).force.allFinite());
    for (int i = 0; i < 40; ++i) {
      const ContactForce after = cures.apply(wall(hand, 1000), hand);
      CHECK(after.force.allFinite());
    }
    if (std::isfinite(bad)) continue;  // a way that long is a motion
    CHECK(cures.apply(wall(hand, 1000), hand).force.z() == Approx(1));
  }
}

}  // namespace
}  // namespace spm
