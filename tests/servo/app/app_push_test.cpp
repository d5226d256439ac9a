// SPDX-License-Identifier: Apache-2.0
// Applications that push a hand, and set effects on it, beside the real loop.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "common/base/smooth_change.hpp"
#include "servo/app/app_effects.hpp"
#include "servo/base/clock.hpp"
#include "servo/shared/shared_words.hpp"
#include "tests/servo/support/loop_beside.hpp"

namespace app_push_test {

using namespace spm;
using namespace spm::servo;
using namespace spm::test;

namespace {

spm_client_push upwards(double newtons, double hold) {
  auto push = sized<spm_client_push>();
  push.force[2] = newtons;
  push.hold = hold;
  return push;
}

/// A spring to a place 5 mm above the hand.
spm_client_effect spring_above() {
  auto spring = sized<spm_client_effect>();
  spring.kind = SPM_CLIENT_SPRING;
  spring.stiffness = 200;
  spring.point[2] = box_half + above + 0.005;
  return spring;
}

/// Goes on pushing until the force is there. Returns false if it never is.
bool pushed_to(const LoopBeside& beside, const spm_client_push& push, double force) {
  return eventually([&] {
    static_cast<void>(spm_client_push_hand(beside.here->client, 0, &push));
    return std::abs(beside.device().force[2] - force) < 0.02;
  });
}

}  // namespace

TEST_CASE("A push is felt, and ends at its deadline while the application hangs") {
  const LoopBeside beside;
  const spm_client_push push = upwards(0.7, 0.3);
  REQUIRE(eventually([&] { return beside.device().connected == 1; }));
  REQUIRE(pushed_to(beside, push, 0.7));
  CHECK(beside.device().contact == 0);
  const std::int64_t begun = now_ns();
  REQUIRE(beside.comes_to(0));
  // The last push was sent before `begun`: it cannot have ended much later than it says.
  CHECK(beside.device().cause == SPM_CLIENT_FORCE_ON);
  CHECK(now_ns() - begun < 20'000'000'000);
}

TEST_CASE("A push comes and goes without a step, by the loop's own records") {
  LoopBeside beside;
  REQUIRE(eventually([&] { return beside.device().connected == 1; }));
  const spm_client_push push = upwards(0.7, 0.05);
  static_cast<void>(beside.records());
  REQUIRE(spm_client_push_hand(beside.here->client, 0, &push) == SPM_CLIENT_OK);
  spm_client_command_counts counts = sized<spm_client_command_counts>();
  REQUIRE(eventually([&] {
    static_cast<void>(spm_client_refusals(beside.here->client, &counts));
    return counts.taken == 1;
  }));
  sleep_until(now_ns() + 200'000'000);
  std::uint64_t first = 0, last = 0;
  double before = 0;
  std::uint64_t tick_before = 0;
  for (const TickRecord& record : beside.records()) {
    const double ticks = static_cast<double>(record.tick - std::exchange(tick_before, record.tick));
    const double now = record.added.force.z();
    CHECK(std::abs(now - std::exchange(before, now)) <= change_rate * 1e-3 * ticks + 1e-9);
    CHECK(now <= 0.7);
    CHECK(record.wanted.force.isZero());
    if (now > 0 && first == 0) first = record.tick;
    if (now > 0) last = record.tick;
  }
  // On a machine that stops the loop for longer than the push, no tick may have it. It fades in 12
  // ms.
  if (first > 0) CHECK(last - first <= 51 + 13);
}

TEST_CASE("A push ends with the application that dies, and so do its effects") {
  LoopBeside beside;
  auto other = std::make_unique<Connected>(beside.path());
  REQUIRE(eventually([&] { return beside.device().connected == 1; }));
  const spm_client_effect spring = spring_above();
  REQUIRE(spm_client_set_effect(other->client, 0, 4, &spring) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(1));
  const spm_client_push push = upwards(0.5, 1);
  REQUIRE(eventually([&] {
    REQUIRE(spm_client_push_hand(other->client, 0, &push) == SPM_CLIENT_OK);
    return std::abs(beside.device().force[2] - 1.5) < 0.02;
  }));
  other.reset();
  CHECK(beside.comes_to(0));
}

TEST_CASE("Pushes and effects stay below every cap, the daemon's and an application's") {
  const LoopBeside beside;
  REQUIRE(eventually([&] { return beside.device().connected == 1; }));
  const double own = beside.device().force_cap;
  REQUIRE(own < 1000);
  const spm_client_push hard = upwards(1000, 1);
  REQUIRE(pushed_to(beside, hard, own));
  REQUIRE(spm_client_set_force_cap(beside.here->client, 0, 0.4) == SPM_CLIENT_OK);
  CHECK(eventually([&] { return beside.device().force_cap == 0.4; }));
  CHECK(pushed_to(beside, hard, 0.4));
}

TEST_CASE("A push beside a contact is added to it, and cannot drown it") {
  const LoopBeside beside;
  const spm_client_pose up = raised(2 * above);
  REQUIRE(spm_client_move_object(beside.here->client, 0, &up) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(1));
  CHECK(pushed_to(beside, upwards(0.5, 1), 1.5));
  CHECK(pushed_to(beside, upwards(-0.5, 1), 0.5));
  const spm_client_push down = upwards(-1000, 1);
  const double cap = beside.device().force_cap;
  CHECK(pushed_to(beside, down, 1 - cap));
}

TEST_CASE("A torque is refused with its reason where the device gives none") {
  const LoopBeside beside;
  spm_client_push push = upwards(0.5, 0.5);
  push.torque[1] = 0.01;
  REQUIRE(spm_client_push_hand(beside.here->client, 0, &push) == SPM_CLIENT_OK);
  CHECK(contains(beside.refusal(), "this device gives no torque"));
  CHECK(beside.device().force[2] == 0);
}

TEST_CASE("A torque is felt under the device's torque cap, and ends with its push") {
  LoopBeside beside(true, false, 0.2);
  REQUIRE(eventually([&] { return beside.device().connected == 1; }));
  CHECK(beside.device().torque_cap == 0.2);
  const auto turned_to = [&](double wanted, double felt) {
    spm_client_push push = upwards(0, 0.5);
    push.torque[1] = wanted;
    return eventually([&] {
      static_cast<void>(spm_client_push_hand(beside.here->client, 0, &push));
      return std::abs(beside.device().torque[1] - felt) < 1e-6;
    });
  };
  CHECK(turned_to(0.05, 0.05));
  CHECK(turned_to(-50, -0.2));
  CHECK(beside.device().force[2] == 0);
  auto counts = sized<spm_client_device_counts>();
  CHECK(eventually([&] {
    static_cast<void>(spm_client_read_device_counts(beside.here->client, 0, &counts));
    return counts.torque_max > 0.199;
  }));
  CHECK(counts.torque_max <= 0.2 * (1 + 1e-12));
  CHECK(eventually([&] { return beside.device().torque[1] == 0; }));
  // Each torque that was sent is in the records, what applications wanted beside it.
  bool added = false;
  for (const TickRecord& record : beside.records()) {
    REQUIRE(record.sent.torque.norm() <= 0.2 * (1 + 1e-12));
    added = added || record.added.torque.y() == 0.05;
  }
  CHECK(added);
}

TEST_CASE("Whatever force a client writes, one that cannot be is refused and never felt") {
  RawRing hostile(99);
  LoopBeside beside;
  beside.attach(hostile);
  static_cast<void>(beside.records());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  std::uint64_t sent = 0;
  const auto refused = [&](const spm_shared_command& command) {
    hostile.write(command);
    ++sent;
    REQUIRE(eventually([&] { return load_acquire(hostile.ring().refused) == sent; }));
    return static_cast<Refusal>(load_relaxed(hostile.ring().last_refusal));
  };
  for (const double value : {nan, infinity, -infinity, 1e9, -1e9}) {
    const Refusal due = std::isfinite(value) ? Refusal::out_of_range : Refusal::not_finite;
    spm_shared_command push = move_command(0, 0);
    push.kind = SPM_COMMAND_PUSH;
    push.hold = 0.5;
    push.force[1] = value;
    CHECK(refused(push) == due);
    push.force[1] = 0;
    push.torque[2] = value;
    CHECK(refused(push) == due);
    push.torque[2] = 0;
    push.hold = value;
    CHECK(refused(push) == due);
    for (const std::uint32_t kind :
         {SPM_EFFECT_SPRING, SPM_EFFECT_VISCOUS, SPM_EFFECT_MAGNET, SPM_EFFECT_DETENTS}) {
      spm_shared_command effect = move_command(0, value);
      effect.kind = SPM_COMMAND_EFFECT;
      effect.effect_kind = kind;
      effect.axis[0] = effect.stiffness = effect.damping = effect.spacing = value;
      effect.range = effect.most_force = value;
      CHECK(refused(effect) == due);
    }
  }
  spm_shared_command unknown = move_command(0, 0);
  unknown.kind = SPM_COMMAND_EFFECT;
  unknown.effect_kind = 77;
  CHECK(refused(unknown) == Refusal::out_of_range);
  unknown.effect_kind = SPM_EFFECT_MAGNET;
  unknown.object = 4711;
  unknown.range = 1e-3;
  CHECK(refused(unknown) == Refusal::unknown_object);
  for (const TickRecord& record : beside.records()) REQUIRE(record.added.force.isZero());
}

TEST_CASE("An effect stays until it is removed, by its own application or by a supervisor") {
  const LoopBeside beside;
  const Connected other(beside.path());
  const Connected supervisor(beside.path(), 20000, SPM_CLIENT_SUPERVISOR);
  spm_client* const own = beside.here->client;
  REQUIRE(eventually([&] { return beside.device().connected == 1; }));
  const spm_client_effect spring = spring_above();
  REQUIRE(spm_client_set_effect(own, 0, 7, &spring) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(1));
  REQUIRE(spm_client_remove_effect(other.client, 0, 7) == SPM_CLIENT_OK);
  auto counts = sized<spm_client_command_counts>();
  REQUIRE(eventually([&] {
    static_cast<void>(spm_client_refusals(other.client, &counts));
    return counts.refused == 1;
  }));
  CHECK(contains(spm_client_refusal(counts.last_refusal), "no effect of that number"));
  CHECK(beside.comes_to(1));
  REQUIRE(spm_client_remove_effect(own, 0, 7) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(0));
  REQUIRE(spm_client_set_effect(own, 0, 7, &spring) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(1));
  REQUIRE(spm_client_remove_effect(supervisor.client, 0, SPM_CLIENT_ALL_EFFECTS) == SPM_CLIENT_OK);
  CHECK(beside.comes_to(0));
}

TEST_CASE("What an effect cannot be is an error of the call") {
  const LoopBeside beside;
  spm_client* const client = beside.here->client;
  spm_client_effect effect = spring_above();
  CHECK(spm_client_set_effect(client, 3, 0, &effect) == SPM_CLIENT_NOT_THERE);
  CHECK(spm_client_set_effect(client, 0, SPM_CLIENT_ALL_EFFECTS, &effect) ==
        SPM_CLIENT_BAD_ARGUMENT);
  CHECK(spm_client_set_effect(client, 0, 0, nullptr) == SPM_CLIENT_BAD_ARGUMENT);
  effect.kind = SPM_CLIENT_DETENTS;  // without an axis
  CHECK(spm_client_set_effect(client, 0, 0, &effect) == SPM_CLIENT_BAD_ARGUMENT);
  effect.size = 4;
  CHECK(spm_client_set_effect(client, 0, 0, &effect) == SPM_CLIENT_BAD_ARGUMENT);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double hold : {0.0, -1.0, 1.5, nan}) {
    const spm_client_push push = upwards(1, hold);
    CHECK(spm_client_push_hand(client, 0, &push) == SPM_CLIENT_BAD_ARGUMENT);
  }
  const spm_client_push far = upwards(1e9, 0.1);
  CHECK(spm_client_push_hand(client, 0, &far) == SPM_CLIENT_BAD_ARGUMENT);
  CHECK(spm_client_push_hand(client, 0, nullptr) == SPM_CLIENT_BAD_ARGUMENT);
}

}  // namespace app_push_test
