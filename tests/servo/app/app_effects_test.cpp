// SPDX-License-Identifier: Apache-2.0
// Effects and pushes by themselves, tick by tick, without a loop.
#include "servo/app/app_effects.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/smooth_change.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace app_effects_test {

using namespace spm;
using namespace spm::servo;

namespace {

constexpr double tick = 1e-3;

/// A hand near a box of 40 mm, on a device that bears 900 N/m and 4 N s/m.
struct Hand {
  Asset box = test::box_asset(0.04);
  AssetTables tables = tables_of(box);
  std::array<const AssetView*, 1> assets{&tables.view()};
  SceneForce force;
  AppEffects effects;
  std::int64_t now = 0;
  Vector3 last = Vector3::Zero();  ///< N, of the last tick

  explicit Hand(const ForceSettings& settings = {}) : force(scene_of(settings), tick, 0) {
    effects.know_device(0, {1000, 4, 900}, 0, tick, 1);
  }
  Vector3 at(const Vector3& tool) {
    now += 1'000'000;
    return last = effects.next(0, tool, 1, now, force, assets).force;
  }
  [[nodiscard]] Refusal set(const AppCommand& command) { return effects.set(command, 0, now); }
  /// After it has faded in, or has gone over into another.
  Vector3 settled_at(const Vector3& tool) {
    for (int i = 0; i < 400; ++i) static_cast<void>(at(tool));
    return at(tool);
  }
  /// The largest step of the force within so many ticks, the one from the last tick included, N.
  double largest_step(const Vector3& tool, int ticks) {
    double largest = 0;
    for (int i = 0; i < ticks; ++i) {
      const Vector3 before = last;
      largest = std::max(largest, (at(tool) - before).norm());
    }
    return largest;
  }
};

AppCommand spring(double stiffness, std::uint32_t number = 0, std::uint32_t connection = 1) {
  AppCommand command;
  command.action = AppAction::effect;
  command.connection = connection;
  command.effect_number = number;
  command.effect.stiffness = stiffness;
  return command;
}

constexpr double ahead = 0.01;  // m

}  // namespace

TEST_CASE("An effect fades in, and goes over into other numbers") {
  Hand hand;
  REQUIRE(hand.set(spring(100)) == Refusal::none);
  CHECK(hand.at({ahead, 0, 0}).isZero());
  CHECK(hand.at({ahead, 0, 0}).x() == Approx(-100 * ahead / 150));
  CHECK(hand.settled_at({ahead, 0, 0}).x() == Approx(-100 * ahead));
  REQUIRE(hand.set(spring(200)) == Refusal::none);
  CHECK(hand.at({ahead, 0, 0}).x() == Approx(-(100 + 100 / 150.) * ahead));
  CHECK(hand.settled_at({ahead, 0, 0}).x() == Approx(-200 * ahead));
  hand.effects.rest(0);
  CHECK(hand.at({ahead, 0, 0}).x() == Approx(-200 * ahead / 150));
}

TEST_CASE("No command for an effect makes a step of the force") {
  Hand hand;
  constexpr double most = change_rate * tick + 1e-9;
  const Vector3 tool(ahead, 0, 0);
  REQUIRE(hand.set(spring(290)) == Refusal::none);
  CHECK(hand.largest_step(tool, 400) <= most);
  AppCommand moved = spring(290);
  moved.effect.point = {-ahead, ahead, 0};
  REQUIRE(hand.set(moved) == Refusal::none);
  CHECK(hand.largest_step(tool, 400) <= most);
  CHECK((hand.at(tool) - 290 * (moved.effect.point - tool)).norm() < 1e-9);
  AppCommand other = moved;
  other.effect.kind = HandEffectKind::detents;
  other.effect.axis = Vector3::UnitX();
  other.effect.spacing = 0.03;
  REQUIRE(hand.set(other) == Refusal::none);
  CHECK(hand.largest_step(tool, 600) <= most);
  other.effect.most_force = 0.1;
  REQUIRE(hand.set(other) == Refusal::none);
  CHECK(hand.largest_step(tool, 400) <= most);
  CHECK(hand.at(tool).norm() == Approx(0.1));
  other.effect.most_force = std::numeric_limits<double>::infinity();
  REQUIRE(hand.set(other) == Refusal::none);
  CHECK(hand.largest_step(tool, 400) <= most);
  CHECK(hand.at(tool).norm() > 1);
  REQUIRE(hand.effects.remove(other) == Refusal::none);
  CHECK(hand.largest_step(tool, 400) <= most);
  CHECK(hand.at(tool).isZero());
}

TEST_CASE("A point that moves at 60 Hz makes no step, and is followed as fast as that allows") {
  Hand hand;
  double largest = 0;
  Vector3 last = Vector3::Zero();
  for (int i = 0; i < 3000; ++i) {
    AppCommand command = spring(290);
    command.effect.point = {0.02 * std::sin(1e-3 * i * std::numbers::pi), 0, 0};
    if (i % 17 == 0) REQUIRE(hand.set(command) == Refusal::none);
    const Vector3 force = hand.at(Vector3::Zero());
    if (i > 500) largest = std::max(largest, (force - last).norm());
    last = force;
  }
  CHECK(largest <= change_rate * tick + 1e-9);
  // Of an even motion the hand gets what it would get of a spring that follows at once, later.
  CHECK(largest > 0.01);
}

TEST_CASE("An effect whose application hangs fades, and comes back with it") {
  Hand hand;
  const Vector3 tool(ahead, 0, 0);
  REQUIRE(hand.set(spring(100)) == Refusal::none);
  const double whole = hand.settled_at(tool).x();
  hand.effects.tell_silent(
      [](std::uint32_t connection, const PoseInterpolator&) { return connection == 1; });
  CHECK(hand.at(tool).x() == Approx(whole * 149 / 150));
  CHECK(hand.settled_at(tool).isZero());
  hand.effects.tell_silent([](std::uint32_t, const PoseInterpolator&) { return false; });
  CHECK(hand.settled_at(tool).x() == Approx(whole));
}

TEST_CASE("All springs on a device together have a third of the stiffness that it bears") {
  Hand hand;
  for (std::uint32_t i = 0; i < 10; ++i) REQUIRE(hand.set(spring(1e5, i)) == Refusal::none);
  CHECK(hand.settled_at({ahead, 0, 0}).x() == Approx(-300 * ahead));
}

TEST_CASE("Beside a touched object effects have what it leaves of the device's stiffness") {
  Hand hand({.stiffness = 900});
  REQUIRE(hand.set(spring(300)) == Refusal::none);
  const Vector3 tool(0, 0, 0.019);  // a millimetre inside the box
  CHECK(hand.settled_at(tool).z() == Approx(-300 * tool.z()));
  // Each tick of contact moves the share a little, down to the 100 N/m that are left.
  static_cast<void>(hand.force.next(hand.assets, tool));
  CHECK(hand.at(tool).z() == Approx(-149. / 150 * 300 * tool.z()));
  CHECK(hand.settled_at(tool).z() == Approx(-100 * tool.z()));
  static_cast<void>(hand.force.next(hand.assets, Vector3(0, 0, 0.03)));
  CHECK(hand.settled_at(tool).z() == Approx(-300 * tool.z()));
}

TEST_CASE("With a longer delay effects are softer, those that are there too") {
  Hand hand;
  REQUIRE(hand.set(spring(1000)) == Refusal::none);
  const double before = hand.settled_at({ahead, 0, 0}).x();
  hand.effects.set_delay(0, 3, 450);
  CHECK(hand.settled_at({ahead, 0, 0}).x() == Approx(0.5 * before));
}

TEST_CASE("All brakes on a device together have half of the damping that it bears") {
  Hand hand;
  for (std::uint32_t i = 0; i < 3; ++i) {
    AppCommand brake = spring(0, i);
    brake.effect.kind = HandEffectKind::viscous;
    brake.effect.damping = 1000;
    REQUIRE(hand.set(brake) == Refusal::none);
  }
  Vector3 force;
  for (int i = 0; i < 400; ++i) force = hand.at({1e-4 * i, 0, 0});
  CHECK(force.x() == Approx(-2 * 0.1).epsilon(1e-3));
  CHECK(hand.settled_at({0.02, 0, 0}).norm() < 1e-12);
}

TEST_CASE("A device that is left alone on an effect swings ever less") {
  // The force acts a tick late, as a real one does at best, and nothing else brakes the mass.
  Hand hand;
  AppCommand effect = spring(1e5);
  effect.effect.kind = GENERATE(HandEffectKind::spring, HandEffectKind::detents);
  effect.effect.axis = Vector3::UnitX();
  effect.effect.spacing = 0.03;
  REQUIRE(hand.set(effect) == Refusal::none);
  constexpr double mass = 0.1;  // kg
  double x = 0.005, speed = 0, late = 0, largest = 0;
  for (int i = 0; i < 3000; ++i) {
    const double now = hand.at({x, 0, 0}).x();
    speed += tick * late / mass;
    x += tick * speed;
    late = now;
    if (i >= 2500) largest = std::max(largest, std::abs(x));
  }
  CHECK(largest < 1e-3);
}

TEST_CASE("A magnet pulls the tool to its object's surface, and is gone with the object") {
  Hand hand;
  const double margin = hand.box.metadata.band.margin;
  REQUIRE(margin > 2e-4);
  AppCommand magnet = spring(200);
  magnet.effect.kind = HandEffectKind::magnet;
  magnet.effect.range = 1;
  REQUIRE(hand.set(magnet) == Refusal::none);
  CHECK(hand.settled_at({0, 0, 0.0201}).isApprox(Vector3(0, 0, -200 * 1e-4), 1e-3));
  CHECK(hand.at({0, 0, 0.0199}).isZero());
  CHECK(hand.at({0, 0, 0.0201 + margin}).isZero());
  hand.effects.drop(0);
  CHECK(hand.settled_at({0, 0, 0.0201}).isZero());
  magnet.action = AppAction::remove_effect;
  CHECK(hand.effects.remove(magnet) == Refusal::unknown_effect);
}

TEST_CASE("The pull of a magnet whose object is removed fades, and a fault ends it") {
  Hand hand;
  const double far = 0.5 * hand.box.metadata.band.margin;
  AppCommand magnet = spring(290);
  magnet.effect.kind = HandEffectKind::magnet;
  magnet.effect.range = 1;
  REQUIRE(hand.set(magnet) == Refusal::none);
  const Vector3 tool(0, 0, 0.02 + far);
  const double pull = hand.settled_at(tool).norm();
  REQUIRE(pull > 2 * change_rate * tick);
  hand.effects.drop(0);
  SECTION("alone") {
    CHECK(hand.largest_step(tool, 400) <= change_rate * tick + 1e-9);
    CHECK(hand.at(tool).isZero());
  }
  SECTION("before a tick without force") {
    hand.effects.rest(0);
    CHECK(hand.at(tool).isZero());
  }
}

TEST_CASE("Pushes of applications are added, end at their time, and replace their own") {
  Hand hand;
  hand.effects.push(0, 0, {{1, 0, 0}}, 500'000'000);
  hand.effects.push(0, 0, {{2, 0, 0}}, 500'000'000);
  hand.effects.push(0, 3, {{0, 1, 0}}, 200'000'000);
  for (int i = 0; i < 100; ++i) static_cast<void>(hand.at(Vector3::Zero()));
  CHECK(hand.at(Vector3::Zero()) == Vector3(2, 1, 0));
  hand.now = 300'000'000;
  for (int i = 0; i < 100; ++i) static_cast<void>(hand.at(Vector3::Zero()));
  CHECK(hand.at(Vector3::Zero()) == Vector3(2, 0, 0));
  hand.effects.leave(0, 1);
  CHECK(hand.at(Vector3::Zero()).x() == Approx(2 - change_rate * tick));
  for (int i = 0; i < 100; ++i) static_cast<void>(hand.at(Vector3::Zero()));
  CHECK(hand.at(Vector3::Zero()).isZero());
}

TEST_CASE("Torques of pushes are added like their forces, and end with them") {
  Hand hand;
  CHECK_FALSE(hand.effects.gives_torque(0));
  hand.effects.know_torque(0, true);
  CHECK(hand.effects.gives_torque(0));
  hand.effects.push(0, 0, {{1, 0, 0}, {0, 0.1, 0}}, 500'000'000);
  hand.effects.push(0, 3, {{0, 0, 0}, {0, 0, 0.2}}, 200'000'000);
  const auto torque = [&] {
    Vector3 last;
    for (int i = 0; i < 400; ++i) {
      last = hand.effects.next(0, Vector3::Zero(), 1, hand.now, hand.force, hand.assets).torque;
    }
    return last;
  };
  CHECK(torque() == Vector3(0, 0.1, 0.2));
  hand.now = 200'000'000;
  CHECK(torque() == Vector3(0, 0.1, 0));
  hand.effects.leave(0, 1);
  CHECK(torque() == Vector3::Zero());
}

TEST_CASE("There is room for sixteen effects, which only their own application removes") {
  Hand hand;
  for (std::uint32_t i = 0; i < 16; ++i) {
    REQUIRE(hand.set(spring(1, i, 1 + i % 2)) == Refusal::none);
  }
  CHECK(hand.set(spring(1, 99)) == Refusal::too_many_effects);
  CHECK(hand.set(spring(2, 0)) == Refusal::none);
  CHECK(hand.effects.remove(spring(0, 1)) == Refusal::unknown_effect);
  CHECK(hand.effects.remove(spring(0, SPM_ALL_EFFECTS)) == Refusal::none);
  CHECK(hand.settled_at({ahead, 0, 0}).x() == Approx(-8 * ahead));
  AppCommand all = spring(0, SPM_ALL_EFFECTS);
  all.supervisor = true;
  CHECK(hand.effects.remove(all) == Refusal::none);
  CHECK(hand.settled_at({ahead, 0, 0}).isZero());
}

TEST_CASE("A position that is not finite, and a device that is not there, get no force") {
  Hand hand;
  REQUIRE(hand.set(spring(100)) == Refusal::none);
  CHECK(hand.at(Vector3::Constant(std::nan(""))).isZero());
  CHECK(hand.effects.next(99, Vector3::Ones(), 1, 0, hand.force, hand.assets).force.isZero());
  AppCommand elsewhere = spring(1);
  elsewhere.index = 99;
  CHECK(hand.set(elsewhere) == Refusal::unknown_device);
}

}  // namespace app_effects_test
