// SPDX-License-Identifier: Apache-2.0
#include "servo/force/contact_model.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/paper/paper_effects.hpp"
#include "tests/support/asset_by_hand.hpp"

namespace spm::contact_model_test {
namespace {

constexpr double size = 0.04;
constexpr double half = size / 2;

/// A hand that slides over the top of a cube, `depth` (m) deep and `step` (m) a tick.
Vector3 sliding(int tick, double depth, double step) {
  return {-0.01 + step * tick, 0.003, half - depth};
}

ContactSettings settings_of(Method method) {
  ContactSettings settings;
  settings.force.method = method;
  settings.force.stiffness = 1000;
  return settings;
}

TEST_CASE("Without effects the model's force is the force law's") {
  const test::SparseCubeByHand cube(size);
  ContactModel model(settings_of(Method::spm));
  for (int tick = 0; tick < 50; ++tick) {
    const Vector3 point = sliding(tick, 0.0015 - 4e-5 * tick, 1e-4);
    const ContactForce wanted = contact_force(cube.view, model.settings().force, point);
    const ContactForce found = model.next(cube.view, point);
    CHECK(found.force == wanted.force);
    CHECK(found.depth == wanted.depth);
    CHECK(found.contact == wanted.contact);
  }
}

TEST_CASE("A proxy's force is stiffness times how far the hand is from it, whatever the depth") {
  const test::SparseCubeByHand cube(size);
  ContactModel model(settings_of(Method::proxy));
  for (int tick = 0; tick <= 100; ++tick) {
    const double depth = -0.001 + 1e-4 * tick;  // the band ends at 2 mm
    const ContactForce found = model.next(cube.view, {0.002, 0.003, half - depth});
    CHECK(found.contact == (depth > 1e-6));
    if (!found.contact) continue;
    CHECK(found.depth == Approx(depth).margin(1e-6));
    CHECK((found.force - 1000 * depth * Vector3::UnitZ()).norm() < 1e-2);
  }
}

TEST_CASE("Friction opposes sliding with mu N, is no more at rest, and ends with the contact") {
  const test::SparseCubeByHand cube(size);
  for (const Method method : {Method::spm, Method::proxy}) {
    ContactSettings settings = settings_of(method);
    settings.effects.friction = {0.5, 0.4, 2000};
    ContactModel model(settings);
    ContactForce last;
    static_cast<void>(model.next(cube.view, sliding(0, -0.0002, 1e-4)));
    for (int tick = 1; tick < 60; ++tick) {
      last = model.next(cube.view, sliding(tick, 0.001, 1e-4));
      const double normal = last.force.z();
      CHECK(std::hypot(last.force.x(), last.force.y()) <= 0.5 * normal + 1e-6);
    }
    CHECK(last.force.z() == Approx(1).margin(1e-3));
    // A proxy lags by its spring's length: its own normal leans back by less than a micrometre.
    CHECK(last.force.x() == Approx(-0.4).margin(0.01));
    const Vector3 rest = sliding(59, 0.001, 1e-4);
    for (int tick = 0; tick < 20; ++tick) {
      CHECK((model.next(cube.view, rest).force - last.force).norm() < 1e-3);
    }
    CHECK(model.next(cube.view, sliding(60, -0.0002, 1e-4)).force.isZero());
  }
}

TEST_CASE("Damping takes from the hand while it moves in contact, and nothing outside") {
  const test::SparseCubeByHand cube(size);
  ContactSettings settings = settings_of(Method::spm);
  settings.effects.damping = 2;
  ContactModel model(settings);
  ContactForce last;
  for (int tick = 0; tick < 40; ++tick) last = model.next(cube.view, sliding(tick, 0.001, 1e-4));
  CHECK(last.force.x() == Approx(-2 * 0.1).margin(1e-6));
  for (int tick = 0; tick < 5; ++tick) {
    CHECK(model.next(cube.view, sliding(tick, -0.0002, 1e-4)).force.isZero());
  }
}

TEST_CASE("Texture is of the place: the same again, and none where its amplitude is 0") {
  const test::SparseCubeByHand cube(size);
  ContactSettings settings = settings_of(Method::spm);
  settings.effects.texture = {50e-6, 1e-3, 7};
  ContactModel once(settings), again(settings);
  double most = 0;
  for (int tick = 0; tick < 200; ++tick) {
    const Vector3 point = sliding(tick, 0.001, 5e-5);
    const ContactForce found = once.next(cube.view, point);
    const Vector3 smooth = contact_force(cube.view, settings.force, point).force;
    most = std::max(most, (found.force - smooth).norm());
    CHECK(again.next(cube.view, point).force == found.force);
  }
  CHECK(most > 0.01);
  CHECK(most < 0.5);
}

TEST_CASE("By the paper's letter friction, damping and noise are those of eq. 17 to 19") {
  const test::BoxByHand box({size, size, size});
  ContactSettings settings = settings_of(Method::paper);
  settings.effects.friction_force = 0.3;
  settings.effects.friction_depth = 100;
  settings.effects.damping = 2;
  ContactModel model(settings);
  static_cast<void>(model.next(box.view, sliding(0, 0.001, 1e-4)));
  const ContactForce found = model.next(box.view, sliding(1, 0.001, 1e-4));
  CHECK(found.force.z() == Approx(1));
  CHECK(found.force.x() == Approx(-0.3 * (1 + 100 * 0.001) - 2 * 0.1).epsilon(0.2));

  // At a sample of the map, whose noise its seed decides.
  double sum = 0, squares = 0;
  constexpr int seeds = 4000;
  for (int seed = 0; seed < seeds; ++seed) {
    ContactSettings rough = settings_of(Method::paper);
    rough.effects.texture_noise = 1e-5;
    rough.effects.noise_seed = static_cast<std::uint64_t>(seed);
    const double off = ContactModel(rough).next(box.view, {0, 0, half - 0.001}).force.z() - 1;
    sum += off;
    squares += off * off;
  }
  CHECK(sum / seeds == Approx(0).margin(1e-3));
  CHECK(std::sqrt(squares / seeds) == Approx(0.01).epsilon(0.1));
}

TEST_CASE(
    "Noise of eq. 19 is the map's: a hand at rest feels no change, one that returns the same") {
  const test::BoxByHand box({size, size, size});
  ContactSettings rough = settings_of(Method::paper);
  rough.effects.texture_noise = 1e-5;
  ContactModel model(rough);
  const double first = model.next(box.view, sliding(0, 0.001, 1e-4)).force.z();
  CHECK(first != Approx(1).margin(1e-6));
  CHECK(model.next(box.view, sliding(0, 0.001, 1e-4)).force.z() == first);
  CHECK(model.next(box.view, sliding(40, 0.001, 1e-4)).force.z() != Approx(first).margin(1e-6));
  CHECK(model.next(box.view, sliding(0, 0.001, 1e-4)).force.z() == first);
  model.reset();
  CHECK(model.next(box.view, sliding(0, 0.001, 1e-4)).force.z() == first);
}

TEST_CASE("By the paper's letter damping counts the ticks that were skipped") {
  const test::BoxByHand box({size, size, size});
  ContactSettings settings = settings_of(Method::paper);
  settings.effects.damping = 2;
  ContactModel model(settings);
  static_cast<void>(model.next(box.view, sliding(0, 0.001, 1e-4)));
  // 0.1 m/s, of which four ticks were not run.
  const ContactForce found = model.next(box.view, sliding(5, 0.001, 1e-4), 5);
  CHECK(found.force.x() == Approx(-2 * 0.1).epsilon(1e-9));
}

TEST_CASE("A model that continues another one holds the same plane where it has no time to look") {
  const test::SparseCubeByHand cube(size);
  ContactModel before(settings_of(Method::spm));
  static_cast<void>(before.next(cube.view, {half - 0.003, 0.003, half - 0.001}));
  ContactSettings softer = settings_of(Method::spm);
  softer.force.stiffness = 500;
  ContactModel after(softer);
  after.continue_from(before);
  // Beyond the edge, where nothing would be found.
  const ContactForce held = after.next(cube.view, {half + 0.001, 0.003, half - 0.0012}, 1, false);
  CHECK(after.care() == Care::held);
  CHECK(held.contact);
  CHECK((held.force - Vector3(0, 0, 500 * 0.0012)).norm() < 1e-6);
}

TEST_CASE("Points that are not finite give nothing, and what came before is forgotten") {
  const test::SparseCubeByHand cube(size);
  ContactSettings settings = settings_of(Method::proxy);
  settings.effects.friction = {0.5, 0.4, 2000};
  settings.effects.damping = 1;
  ContactModel model(settings);
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    static_cast<void>(model.next(cube.view, sliding(0, 0.001, 0)));
    const ContactForce none = model.next(cube.view, {bad, 0, half});
    CHECK(none.force.isZero());
    CHECK_FALSE(none.contact);
    CHECK(model.next(cube.view, sliding(0, 0.001, 0)).force.allFinite());
  }
}

TEST_CASE("Smoothing over a kernel leaves a plane as it is and rounds an edge") {
  const test::SparseCubeByHand cube(size);
  ContactSettings settings = settings_of(Method::spm);
  settings.effects.smoothing = {100e-6, 9};
  ContactModel model(settings);
  const ContactForce flat = model.next(cube.view, {0.002, 0.003, half - 0.001});
  CHECK((flat.force - Vector3::UnitZ()).norm() < 1e-3);
  // Across the edge's bisector the direction turns by a quarter at once; smoothed, by steps.
  double largest = 0;
  Vector3 last = Vector3::Zero();
  for (int k = 0; k <= 200; ++k) {
    const double x = half - 0.0013 + 3e-6 * k;
    const Vector3 force = model.next(cube.view, {x, 0.003, half - 0.001}).force;
    if (k > 0) largest = std::max(largest, (force - last).norm());
    last = force;
  }
  CHECK(largest < 0.4);
  CHECK(largest > 0);
}

TEST_CASE("A turn is limited to its rate, unless the side itself changes") {
  const Vector3 from = Vector3::UnitX();
  const auto at = [](double angle) { return Vector3(std::cos(angle), std::sin(angle), 0); };
  CHECK((limited_turn(from, at(0.05), 0.1, 0.6) - at(0.05)).norm() < 1e-12);
  CHECK((limited_turn(from, at(0.5), 0.1, 0.6) - at(0.1)).norm() < 1e-12);
  CHECK((limited_turn(from, at(0.7), 0.1, 0.6) - at(0.7)).norm() < 1e-12);
  CHECK((limited_turn(from, -from, 0.1, 4) + from).norm() < 1e-12);
  CHECK((limited_turn(from, from, 0.1, 0.6) - from).norm() < 1e-12);
}

TEST_CASE("A limit on turns changes the direction of a force, and neither size nor a proxy") {
  const test::SparseCubeByHand cube(size);
  for (const Method method : {Method::spm, Method::proxy}) {
    ContactSettings settings = settings_of(method);
    ContactModel plain(settings);
    settings.effects.turn = {100, 2};  // 0.1 rad a tick; the edge's quarter turn is limited
    ContactModel limited(settings);
    Vector3 last = Vector3::Zero();
    double differs = 0;
    for (int tick = 0; tick <= 60; ++tick) {
      // Across the edge's bisector.
      const Vector3 point(half - 0.0013 + 1e-5 * tick, 0.003, half - 0.001);
      const ContactForce wanted = plain.next(cube.view, point);
      const ContactForce found = limited.next(cube.view, point);
      CHECK(found.depth == wanted.depth);
      CHECK(found.force.norm() == Approx(wanted.force.norm()));
      if (method == Method::spm && tick > 0) CHECK((found.force - last).norm() < 0.11);
      differs = std::max(differs, (found.force - wanted.force).norm());
      last = found.force;
    }
    CHECK((differs > 0.5) == (method == Method::spm));
  }
}

TEST_CASE("A limit on turns holds for what a hand can do in a tick, not for single places") {
  const test::SparseCubeByHand cube(size);
  ContactSettings settings = settings_of(Method::spm);
  ContactModel plain(settings);
  settings.effects.turn = {100, 2, 1e-3};
  ContactModel limited(settings);
  // To and fro between two sides of an edge.
  for (int tick = 0; tick < 10; ++tick) {
    const Vector3 point = tick % 2 == 0 ? Vector3(half - 0.003, 0.003, half - 0.001)
                                        : Vector3(half - 0.001, 0.003, half - 0.003);
    CHECK(limited.next(cube.view, point).force == plain.next(cube.view, point).force);
  }
}

TEST_CASE("A smoothed force is that of an energy: no closed path gains any") {
  const test::SparseCubeByHand cube(size);
  const ForceSettings force = settings_of(Method::spm).force;
  const RuntimeSmoothing smoothing{100e-6, 9};
  double work = 0, swept = 0;
  const auto place = [](double turn) {
    return Vector3(half - 0.001 + 0.0006 * std::cos(turn), 0.003,
                   half - 0.001 + 0.0006 * std::sin(turn));
  };
  constexpr int steps = 4000;
  for (int k = 0; k < steps; ++k) {
    const double turn = 2 * std::numbers::pi * k / steps, step = 2 * std::numbers::pi / steps;
    const Vector3 way = place(turn + step) - place(turn);
    const Vector3 middle = place(turn + step / 2);
    const Vector3 felt = smoothed_force(cube.view, force, smoothing, middle).force;
    work += felt.dot(way);
    swept += std::abs(felt.dot(way));
  }
  CHECK(std::abs(work) < 2e-3 * swept);
}

}  // namespace
}  // namespace spm::contact_model_test
