// SPDX-License-Identifier: Apache-2.0
#include "servo/force/force_budget.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "servo/force/scene_force.hpp"
#include "tests/support/asset_by_hand.hpp"

namespace spm::force_budget_test {
namespace {

constexpr double size = 0.04;
constexpr double half = size / 2;
constexpr double tick = 1e-3;

using Assets = std::array<const AssetView*, 1>;

/// A clock that is put forward by a microsecond whenever it is read.
std::int64_t fake_now = 0;
std::int64_t fake_clock() noexcept { return fake_now += 1000; }

/// Time for so many objects, if each takes a microsecond.
ForceBudget time_for(std::size_t objects) {
  fake_now = 0;
  ForceBudget budget;
  budget.clock = fake_clock;
  budget.until_ns = static_cast<std::int64_t>(objects) * 1000;
  return budget;
}

ForceScene crowd_of(std::size_t count, Method method) {
  ForceScene scene;
  PlacedObject object;
  object.force.method = method;
  object.force.stiffness = 100;
  object.effects.friction = {0.3, 0.2, 100};
  object.effects.texture = {20e-6, 1e-3, 7};
  scene.objects.assign(count, object);
  return scene;
}

/// A hand that comes down onto a cube, slides over its top and over the edge, and comes back.
Vector3 hand_at(int at) {
  const double along = 0.03 * std::sin(at * 2e-3);
  const double depth = 1e-3 * std::min(1.0, at / 200.0) + 1e-4 * std::sin(0.05 * at) - 2e-4;
  return {along, 0.003, half - depth};
}

}  // namespace

TEST_CASE("With time for all objects a budget changes no bit") {
  const test::SparseCubeByHand cube(size);
  const ForceScene scene = crowd_of(4, Method::proxy);
  SceneForce free(scene, tick, 0), timed(scene, tick, 0);
  for (int at = 0; at < 500; ++at) {
    const ContactForce wanted = free.next(Assets{&cube.view}, hand_at(at));
    const ContactForce found = timed.next(Assets{&cube.view}, hand_at(at), 1, time_for(100));
    REQUIRE(found.force == wanted.force);
    REQUIRE_FALSE(timed.effort().degraded());
    REQUIRE(timed.effort().exact == 4);
  }
}

TEST_CASE("Without time for all touched objects each is exact in its turn, and none is left out") {
  const test::SparseCubeByHand cube(size);
  SceneForce force(crowd_of(8, Method::spm), tick, 0);
  const Vector3 pressed(0.001, 0.002, half - 1e-3);
  const ContactForce all = force.next(Assets{&cube.view}, pressed);
  std::array<int, 8> begun{};
  for (int at = 0; at < 80; ++at) {
    const ContactForce some = force.next(Assets{&cube.view}, pressed, 1, time_for(3));
    REQUIRE(some.force.norm() == Approx(all.force.norm()).epsilon(1e-9));
    const ForceEffort& effort = force.effort();
    REQUIRE(effort.exact + effort.held == 8);
    REQUIRE(effort.exact == 3);
    REQUIRE(effort.shortened == 0);
    ++begun[effort.first];
  }
  for (const int count : begun) CHECK(count == 10);
}

TEST_CASE("One object at least is exact, however late it is") {
  const test::SparseCubeByHand cube(size);
  SceneForce force(crowd_of(3, Method::proxy), tick, 0);
  for (int at = 0; at < 300; ++at) {
    static_cast<void>(force.next(Assets{&cube.view}, hand_at(at), 1, time_for(0)));
    REQUIRE(force.effort().exact == 1);
  }
}

TEST_CASE("Too little time makes no step in the force that exactness does not make") {
  const test::SparseCubeByHand cube(size);
  constexpr std::size_t count = 16;
  for (const Method method : {Method::spm, Method::proxy}) {
    for (const std::size_t time : {1U, 5U, 12U}) {
      const ForceScene scene = crowd_of(count, method);
      SceneForce exact(scene, tick, 0), coarse(scene, tick, 0);
      Vector3 exact_last = Vector3::Zero(), coarse_last = Vector3::Zero();
      double exact_step = 0, coarse_step = 0, apart = 0;
      std::size_t degraded = 0;
      for (int at = 0; at < 4000; ++at) {
        const Vector3 hand = hand_at(at);
        const Vector3 one = exact.next(Assets{&cube.view}, hand).force;
        const Vector3 two = coarse.next(Assets{&cube.view}, hand, 1, time_for(time)).force;
        degraded += coarse.effort().degraded() ? 1 : 0;
        exact_step = std::max(exact_step, (one - exact_last).norm());
        coarse_step = std::max(coarse_step, (two - coarse_last).norm());
        apart = std::max(apart, (one - two).norm());
        exact_last = one;
        coarse_last = two;
      }
      CAPTURE(method, time, exact_step, coarse_step, apart);
      CHECK(degraded > 500);
      CHECK(coarse_step <= 1.05 * exact_step + 0.01);
    }
  }
}

TEST_CASE("A tick that had too little time is computed again to the bit without a clock") {
  const test::SparseCubeByHand cube(size);
  for (const Method method : {Method::spm, Method::proxy}) {
    const ForceScene scene = crowd_of(12, method);
    SceneForce live(scene, tick, 0), again(scene, tick, 0);
    std::size_t degraded = 0;
    for (int at = 0; at < 3000; ++at) {
      const std::size_t time = static_cast<std::size_t>(at * 7 % 17);
      const ContactForce one = live.next(Assets{&cube.view}, hand_at(at), 1, time_for(time));
      const ForceEffort effort = live.effort();
      const ContactForce two =
          again.next(Assets{&cube.view}, hand_at(at), 1, ForceBudget::again(effort));
      REQUIRE(one.force == two.force);
      REQUIRE(again.effort().held == effort.held);
      REQUIRE(again.effort().shortened == effort.shortened);
      degraded += effort.degraded() ? 1 : 0;
      if (at % 500 == 499) {
        live.reset();
        again.reset();
      }
    }
    CHECK(degraded > 500);
  }
}

TEST_CASE("A plane that is held moves with its object, and lets go where the hand leaves it") {
  const test::SparseCubeByHand cube(size);
  SceneForce force(crowd_of(2, Method::spm), tick, 0);
  const Vector3 pressed(0.001, 0.002, half - 1e-3);
  static_cast<void>(force.next(Assets{&cube.view}, pressed));
  ForceBudget none;
  none.first = 0;
  none.most = 0;
  // Both objects are held. One sinks by half the depth, so half of its force goes.
  const double before = force.next(Assets{&cube.view}, pressed, 1, none).force.z();
  REQUIRE(force.effort().held == 2);
  force.place(1, {0, 0, -0.5e-3}, Eigen::Quaterniond::Identity());
  CHECK(force.next(Assets{&cube.view}, pressed, 1, none).force.z() ==
        Approx(0.75 * before).epsilon(0.03));
  const ContactForce left = force.next(Assets{&cube.view}, {0.001, 0.002, half + 1e-3}, 1, none);
  CHECK_FALSE(left.contact);
  CHECK(left.force == Vector3::Zero());
}

TEST_CASE("A free hand is stopped by a surface that it meets while there is no time") {
  const test::SparseCubeByHand cube(size);
  SceneForce force(crowd_of(6, Method::proxy), tick, 0);
  ForceBudget none;
  none.first = 0;
  none.most = 0;
  double last = 0;
  // At 0.2 m/s, from above to 2 mm below.
  for (int at = 0; at < 30; ++at) {
    const Vector3 hand(0.001, 0.002, half + 4e-3 - 0.2e-3 * at);
    const ContactForce found = force.next(Assets{&cube.view}, hand, 1, none);
    const double depth = std::max(0.0, half - hand.z());
    CHECK(found.force.z() == Approx(6 * 100 * depth).margin(0.02));
    CHECK(found.force.z() - last < 0.16);
    last = found.force.z();
  }
}

}  // namespace spm::force_budget_test
