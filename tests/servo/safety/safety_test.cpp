// SPDX-License-Identifier: Apache-2.0
#include "servo/safety/safety.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <string>

#include "common/base/random.hpp"
#include "common/base/smooth_change.hpp"

namespace safety_test {

using namespace spm::servo;
using spm::direction_of;
using spm::HandPose;
using spm::Random;
using spm::random_unit;
using spm::Vector3;
using spm::Wrench;

namespace {

constexpr SafetySettings settings{8.0, 2.0, 1e-3, 0.5, 0.02};

SafetyStage engaged() {
  SafetyStage stage(settings);
  for (int i = 0; i < 200; ++i) static_cast<void>(stage.apply(Wrench{}, ForceOff::none));
  return stage;
}

}  // namespace

TEST_CASE("A force that is not a number becomes zero with its cause") {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    SafetyStage stage = engaged();
    const SafeWrench sent = stage.apply(Wrench{{0, bad, 0}}, ForceOff::none);
    REQUIRE(sent.force == Vector3::Zero());
    REQUIRE(sent.cause == ForceOff::not_a_number);
  }
}

TEST_CASE("Every cause makes the force zero and is passed on") {
  for (std::size_t i = 1; i < force_off_count; ++i) {
    SafetyStage stage = engaged();
    const auto cause = static_cast<ForceOff>(i);
    const SafeWrench sent = stage.apply(Wrench{{1, 2, 3}}, cause);
    REQUIRE(sent.force == Vector3::Zero());
    REQUIRE(sent.cause == cause);
  }
}

TEST_CASE("Every cause has a name of its own and a cure") {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < force_off_count; ++i) {
    const auto cause = static_cast<ForceOff>(i);
    names.emplace_back(to_string(cause));
    REQUIRE_FALSE(std::string(cure_of(cause)).empty());
  }
  std::sort(names.begin(), names.end());
  REQUIRE(std::adjacent_find(names.begin(), names.end()) == names.end());
}

TEST_CASE("The cap holds the magnitude and keeps the direction") {
  SafetyStage stage = engaged();
  const Vector3 wanted(30, -40, 0);
  SafeWrench sent;
  for (int i = 0; i < 50; ++i) sent = stage.apply(Wrench{wanted}, ForceOff::none);
  REQUIRE(sent.capped);
  REQUIRE(sent.force.norm() == Approx(8.0));
  REQUIRE(sent.force.normalized().dot(wanted.normalized()) == Approx(1.0));
}

TEST_CASE("No force beyond the cap is ever sent, whatever is wanted") {
  Random random(3);
  SafetyStage stage(settings);
  for (int i = 0; i < 20'000; ++i) {
    const Vector3 wanted = random.direction() * random.between(0, 100);
    const auto cause = random.next() % 50 == 0 ? ForceOff::asset_lost : ForceOff::none;
    REQUIRE(stage.apply(Wrench{wanted}, cause).force.norm() <= 8.0 * (1 + 1e-12));
  }
}

TEST_CASE("The force fades in evenly after engaging") {
  SafetyStage stage(settings);
  double last = 0;
  for (int i = 1; i <= 150; ++i) {
    const double sent = stage.apply(Wrench{{1, 0, 0}}, ForceOff::none).force.x();
    REQUIRE(sent == Approx(i / 150.0));
    REQUIRE(sent > last);
    last = sent;
  }
  REQUIRE(stage.apply(Wrench{{1, 0, 0}}, ForceOff::none).force.x() == 1.0);
}

TEST_CASE("The soft start begins again after a tick without force") {
  SafetyStage stage = engaged();
  static_cast<void>(stage.apply(Wrench{{1, 0, 0}}, ForceOff::asset_lost));
  REQUIRE(stage.is_off());
  REQUIRE(stage.apply(Wrench{{1, 0, 0}}, ForceOff::none).force.x() == Approx(1. / 150));
}

TEST_CASE("A soft start of a large force takes longer, so that no tick makes a knock") {
  SafetySettings strong = settings;
  strong.force_cap = 30;
  SafetyStage stage(strong);
  double last = 0;
  int ticks = 0;
  for (; last < 20 && ticks < 1000; ++ticks) {
    const double sent = stage.apply(Wrench{{20, 0, 0}}, ForceOff::none).force.x();
    REQUIRE(sent - last <= spm::change_rate * 1e-3 + 1e-9);
    last = sent;
  }
  CHECK(ticks == Approx(334).margin(1));
}

TEST_CASE(
    "A soft start gives a hand that moves no energy: it is a share of the force at each place") {
  SafetyStage stage(settings);
  // J: a hand presses a wall of 1 N/mm by 2 mm and lets go, twenty times, from the first tick on.
  double energy = 0, before = 0, deep_before = 0;
  for (int i = 0; i < 2000; ++i) {
    const double deep = 1e-3 * (1 - std::cos(2 * 3.14159265358979 * i / 100));
    const double force = stage.apply(Wrench{{1000 * deep, 0, 0}}, ForceOff::none).force.x();
    energy += 0.5 * (force + before) * (deep_before - deep);
    // What a hand puts into a spring that is weak still is less than it gets out of it later: the
    // change of the potential itself, at most once all of it.
    REQUIRE(energy <= 0.5 * 1000 * 4e-6 + 1e-9);
    before = force;
    deep_before = deep;
  }
  CHECK(energy < 0.5 * 1000 * 4e-6);
}

TEST_CASE("Contact made by a hand of up to 1 m/s passes the slew limit unchanged") {
  for (const double rate : {500.0, 1000.0, 4000.0}) {
    for (const double stiffness : {100.0, 1000.0, 5000.0}) {
      SafetyStage stage(safety_settings(1e3, stiffness, rate));
      for (int i = 0; i < 1000; ++i)
        static_cast<void>(stage.apply(Wrench{{0, 0, 0}}, ForceOff::none));
      for (int i = 1; i <= 20; ++i) {
        const Vector3 wanted(0, 0, stiffness * i / rate);
        const SafeWrench sent = stage.apply(Wrench{wanted}, ForceOff::none);
        REQUIRE(sent.force == wanted);
        REQUIRE_FALSE(sent.slewed);
      }
    }
  }
}

TEST_CASE("A sudden force grows no faster than the slew limit, and ends at once") {
  SafetyStage stage = engaged();
  const SafeWrench first = stage.apply(Wrench{{0, 7, 0}}, ForceOff::none);
  REQUIRE(first.slewed);
  REQUIRE(first.force.norm() == Approx(2.0));
  for (int i = 0; i < 5; ++i) static_cast<void>(stage.apply(Wrench{{0, 7, 0}}, ForceOff::none));
  REQUIRE(stage.apply(Wrench{{0, 0, 0}}, ForceOff::none).force == Vector3::Zero());
}

TEST_CASE("Another slew limit holds from the next tick on") {
  SafetyStage stage = engaged();
  stage.set_slew_limits(0.5, 1);
  REQUIRE(stage.apply(Wrench{{0, 7, 0}}, ForceOff::none).force.norm() == Approx(0.5));
  stage.set_slew_limits(3, 1);
  REQUIRE(stage.apply(Wrench{{0, 7, 0}}, ForceOff::none).force.norm() == Approx(3.5));
  REQUIRE(slew_limit(2000, 1000) == Approx(safety_settings(1, 2000, 1000).slew_limit));
  REQUIRE(slew_limit(2000, 1000) > slew_limit(1000, 1000));
}

TEST_CASE("A force that turns round passes through smaller ones") {
  SafetyStage stage = engaged();
  for (int i = 0; i < 10; ++i) static_cast<void>(stage.apply(Wrench{{5, 0, 0}}, ForceOff::none));
  Vector3 last(5, 0, 0);
  for (int i = 0; i < 10; ++i) {
    const Vector3 sent = stage.apply(Wrench{{-5, 0, 0}}, ForceOff::none).force;
    REQUIRE((sent - last).norm() <= 2.0 + 1e-12);
    REQUIRE(sent.norm() <= 5.0 + 1e-12);
    last = sent;
  }
  REQUIRE(last.x() == -5.0);
}

TEST_CASE(
    "What is not trusted for long is held, fades out evenly, and fades in from where it was") {
  SafetyStage stage = engaged();
  const Vector3 wanted(1, 0, 0);
  double last = stage.apply(Wrench{wanted}, ForceOff::none).force.x();
  REQUIRE(last == 1);
  for (int i = 1; i < 500; ++i) {
    const SafeWrench sent = stage.apply(Wrench{wanted}, ForceOff::none, Fade::silent);
    REQUIRE(sent.cause == ForceOff::none);
    REQUIRE(sent.force.x() == Approx(1 - i / 500.0));
  }
  for (int i = 0; i < 10; ++i) {
    const SafeWrench sent = stage.apply(Wrench{wanted}, ForceOff::none, Fade::silent);
    REQUIRE(sent.force.norm() < 1e-12);
  }
  REQUIRE(stage.apply(Wrench{wanted}, ForceOff::none, Fade::silent).cause ==
          ForceOff::application_silent);
  REQUIRE(stage.apply(Wrench{wanted}, ForceOff::none).force.x() == Approx(1. / 150));

  stage = engaged();
  for (int i = 0; i < 250; ++i) {
    last = stage.apply(Wrench{wanted}, ForceOff::none, Fade::silent).force.x();
  }
  for (int i = 0; i < 150; ++i) {
    const double next = stage.apply(Wrench{wanted}, ForceOff::none).force.x();
    REQUIRE(std::abs(next - last) <= 1. / 150 + 1e-12);
    last = next;
  }
  REQUIRE(last == 1);
}

TEST_CASE("A clutch that is taken lets the force fade, and is then the cause") {
  SafetyStage stage = engaged();
  const Vector3 wanted(6, 0, 0);
  for (int i = 0; i < 10; ++i) static_cast<void>(stage.apply(Wrench{wanted}, ForceOff::none));
  double last = 6;
  int ticks = 0;
  SafeWrench sent;
  for (; !stage.is_off() && ticks < 1000; ++ticks) {
    sent = stage.apply(Wrench{wanted}, ForceOff::none, Fade::clutch);
    REQUIRE(last - sent.force.x() <= spm::change_rate * 1e-3 + 1e-9);
    last = sent.force.x();
  }
  CHECK(ticks == Approx(150).margin(1));
  CHECK(sent.cause == ForceOff::clutched);
}

TEST_CASE("A cap that an application moves goes there without a step, and at once without force") {
  SafetyStage stage = engaged();
  const Vector3 wanted(7.9, 0, 0);
  for (int i = 0; i < 10; ++i) static_cast<void>(stage.apply(Wrench{wanted}, ForceOff::none));
  double last = 7.9;
  for (int i = 0; i < 2000; ++i) {
    // In turns, at 60 Hz.
    if (i % 17 == 0) stage.set_force_cap(i % 34 == 0 ? 1 : 8);
    const double sent = stage.apply(Wrench{wanted}, ForceOff::none).force.x();
    REQUIRE(std::abs(sent - last) <= spm::change_rate * 1e-3 + 1e-9);
    last = sent;
  }
  stage.set_force_cap(1);
  for (int i = 0; i < 200; ++i) static_cast<void>(stage.apply(Wrench{wanted}, ForceOff::none));
  CHECK(stage.apply(Wrench{wanted}, ForceOff::none).force.x() == Approx(1));
  CHECK(stage.force_cap() == 1);
  SafetyStage fresh(settings);
  fresh.set_force_cap(0.5);
  static_cast<void>(fresh.apply(Wrench{wanted}, ForceOff::none));
  CHECK(fresh.force_cap() == 0.5);
}

TEST_CASE("Never is more sent than is wanted") {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SafetyStage stage = engaged();
    for (std::uint64_t i = 0; i < 1000; ++i) {
      const ForceOff cause =
          random_unit(seed, 4 * i) < 1.0 / 64 ? ForceOff::device_silent : ForceOff::none;
      const Vector3 wanted =
          5 * random_unit(seed, 4 * i + 1) *
          direction_of(random_unit(seed, 4 * i + 2), random_unit(seed, 4 * i + 3));
      CHECK(stage.apply(Wrench{wanted}, cause).force.norm() <= wanted.norm() + 1e-9);
    }
  }
}

TEST_CASE("A cause of zero force wins over fading, and the force then begins at zero") {
  SafetyStage stage = engaged();
  for (int i = 0; i < 100; ++i)
    static_cast<void>(stage.apply(Wrench{{1, 0, 0}}, ForceOff::none, Fade::silent));
  REQUIRE(stage.apply(Wrench{{1, 0, 0}}, ForceOff::device_gone, Fade::silent).cause ==
          ForceOff::device_gone);
  REQUIRE(stage.apply(Wrench{{1, 0, 0}}, ForceOff::none, Fade::silent).force.x() < 0.01);
  REQUIRE(stage.apply(Wrench{{1, 0, 0}}, ForceOff::none).force.x() < 0.02);
}

TEST_CASE(
    "A position that no hand reaches in a tick has jumped, and the next is compared with it") {
  JumpGate gate(1000);
  REQUIRE_FALSE(gate.jumped(HandPose{{0, 0, 0}}, 0));
  REQUIRE_FALSE(gate.jumped(HandPose{{0.0099, 0, 0}}, 1));
  REQUIRE(gate.jumped(HandPose{{0.03, 0, 0}}, 2));
  REQUIRE_FALSE(gate.jumped(HandPose{{0.031, 0, 0}}, 3));
}

TEST_CASE(
    "Ticks that were skipped leave a hand the more room, and a device that was away all of it") {
  JumpGate gate(1000);
  REQUIRE_FALSE(gate.jumped(HandPose{{0, 0, 0}}, 7));
  REQUIRE_FALSE(gate.jumped(HandPose{{0.029, 0, 0}}, 10));
  REQUIRE(gate.jumped(HandPose{{0.06, 0, 0}}, 13));
  gate.forget();
  REQUIRE_FALSE(gate.jumped(HandPose{{1, 1, 1}}, 14));
}

TEST_CASE("A workspace has a margin, and one that is not known bounds nothing") {
  const Vector3 half_edges(0.1, 0.2, 0);
  REQUIRE_FALSE(is_outside({0.12, -0.24, 7}, half_edges));
  REQUIRE(is_outside({0.126, 0, 0}, half_edges));
  REQUIRE(is_outside({0, -0.251, 0}, half_edges));
  REQUIRE_FALSE(is_outside({5, 5, 5}, Vector3::Zero()));
}

}  // namespace safety_test
