// SPDX-License-Identifier: Apache-2.0
#include "servo/shared/app_command.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "common/base/random.hpp"
#include "servo/app/app_state.hpp"
#include "servo/shared/shared_words.hpp"
#include "tests/servo/support/loop_stand_in.hpp"

namespace app_command_test {

using namespace spm;
using namespace spm::servo;
using namespace spm::test;

namespace {

/// A complete and valid command of each kind.
spm_shared_command good_command(std::uint32_t kind, std::uint32_t connection) {
  spm_shared_command command = move_command(std::uint64_t{connection} << 32U | 1U, 0.1);
  command.kind = kind;
  command.scale = 2;
  command.period = 0.011;
  command.fields = SPM_MATERIAL_ALL;
  command.stiffness = 800;
  command.friction_stick = 0.5;
  command.friction_slide = 0.4;
  command.damping = 2;
  command.texture_amplitude = 5e-5;
  command.texture_wavelength = 1e-3;
  command.texture_seed = 7;
  command.on = 1;
  return command;
}

}  // namespace

TEST_CASE("A good command of each kind arrives with its numbers") {
  const auto state = small_state();
  RawRing ring(5);
  state->rings()[3].offer(ring.attached());
  for (const std::uint32_t kind : {SPM_COMMAND_ADD, SPM_COMMAND_MOVE, SPM_COMMAND_MATERIAL,
                                   SPM_COMMAND_CLUTCH, SPM_COMMAND_REMOVE}) {
    ring.write(good_command(kind, 5));
  }
  const auto taken = state->take(1);
  REQUIRE(taken.size() == 5);
  for (std::size_t i = 0; i < taken.size(); ++i) {
    REQUIRE(taken[i].client == 3);
    REQUIRE(taken[i].connection == 5);
    REQUIRE(taken[i].sequence == i + 1);
  }
  REQUIRE(taken[0].action == AppAction::add);
  REQUIRE(taken[0].pose.position == Vector3(0.1, 0, 0));
  REQUIRE(taken[0].pose.scale == 2);
  REQUIRE(taken[0].object >> 32U == 5);
  REQUIRE(taken[1].action == AppAction::move);
  REQUIRE(taken[1].period == 0.011);
  REQUIRE(taken[2].action == AppAction::material);
  REQUIRE(taken[2].material.given == SPM_MATERIAL_ALL);
  REQUIRE(taken[2].material.stiffness == 800);
  REQUIRE(taken[2].material.friction_stick == 0.5);
  REQUIRE(taken[2].material.friction_slide == 0.4);
  REQUIRE(taken[2].material.damping == 2);
  REQUIRE(taken[2].material.texture.amplitude == 5e-5);
  REQUIRE(taken[2].material.texture.seed == 7);
  REQUIRE(taken[3].action == AppAction::clutch);
  REQUIRE(taken[3].on);
  REQUIRE(taken[4].action == AppAction::remove);
  REQUIRE(ring.ring().tail == 5);
  REQUIRE(ring.ring().refused == 0);
  REQUIRE(state->take(2).empty());
}

TEST_CASE("A command with a number that is wrong is refused with its reason") {
  const double nan = std::nan("");
  const double infinity = std::numeric_limits<double>::infinity();
  struct Case {
    std::uint32_t kind;
    Refusal refusal;
    std::function<void(spm_shared_command&)> spoil;
  };
  const std::vector<Case> cases{
      {SPM_COMMAND_MOVE, Refusal::not_finite, [&](auto& c) { c.position[1] = nan; }},
      {SPM_COMMAND_MOVE, Refusal::not_finite, [&](auto& c) { c.orientation[2] = infinity; }},
      {SPM_COMMAND_MOVE, Refusal::out_of_range, [](auto& c) { c.position[2] = -101; }},
      {SPM_COMMAND_MOVE, Refusal::out_of_range, [](auto& c) { c.orientation[0] = 0.9; }},
      {SPM_COMMAND_MOVE, Refusal::out_of_range, [](auto& c) { c.orientation[0] = 0; }},
      {SPM_COMMAND_MOVE, Refusal::out_of_range, [](auto& c) { c.period = 2; }},
      {SPM_COMMAND_MOVE, Refusal::out_of_range, [](auto& c) { c.period = -0.01; }},
      {SPM_COMMAND_MOVE, Refusal::not_finite, [&](auto& c) { c.period = nan; }},
      {SPM_COMMAND_MOVE, Refusal::too_late, [](auto& c) { c.deadline_ns = 999; }},
      {SPM_COMMAND_ADD, Refusal::unknown_asset, [](auto& c) { c.index = 1; }},
      {SPM_COMMAND_ADD, Refusal::unknown_asset, [](auto& c) { c.index = 0xffffffffU; }},
      {SPM_COMMAND_ADD, Refusal::out_of_range, [](auto& c) { c.scale = 0; }},
      {SPM_COMMAND_ADD, Refusal::not_finite, [&](auto& c) { c.scale = nan; }},
      {SPM_COMMAND_ADD, Refusal::not_yours, [](auto& c) { c.object = 1; }},
      {SPM_COMMAND_REMOVE, Refusal::not_yours, [](auto& c) { c.object = 0; }},
      {SPM_COMMAND_MATERIAL, Refusal::out_of_range, [](auto& c) { c.stiffness = -1; }},
      {SPM_COMMAND_MATERIAL, Refusal::out_of_range, [](auto& c) { c.stiffness = 1e6; }},
      {SPM_COMMAND_MATERIAL, Refusal::not_finite, [&](auto& c) { c.damping = infinity; }},
      {SPM_COMMAND_MATERIAL, Refusal::out_of_range, [](auto& c) { c.friction_slide = 0.6; }},
      {SPM_COMMAND_MATERIAL, Refusal::out_of_range, [](auto& c) { c.texture_wavelength = 0; }},
      {SPM_COMMAND_MATERIAL, Refusal::out_of_range, [](auto& c) { c.fields = 16; }},
      {SPM_COMMAND_CLUTCH, Refusal::unknown_device, [](auto& c) { c.index = 1; }},
      {SPM_COMMAND_CLUTCH, Refusal::out_of_range, [](auto& c) { c.on = 2; }},
      {SPM_COMMAND_FORCE_CAP, Refusal::unknown_device, [](auto& c) { c.index = 1; }},
      {SPM_COMMAND_FORCE_CAP, Refusal::out_of_range, [](auto& c) { c.force_cap = -1; }},
      {SPM_COMMAND_FORCE_CAP, Refusal::out_of_range, [](auto& c) { c.force_cap = 1e9; }},
      {SPM_COMMAND_FORCE_CAP, Refusal::not_finite, [&](auto& c) { c.force_cap = nan; }},
      {SPM_COMMAND_METHOD, Refusal::out_of_range, [](auto& c) { c.index = 3; }},
      {SPM_COMMAND_STABILIZE, Refusal::out_of_range, [](auto& c) { c.on = 2; }},
      {0, Refusal::unknown_kind, [](auto&) {}},
      {77, Refusal::unknown_kind, [](auto&) {}},
  };
  const auto state = small_state();
  RawRing ring(1);
  state->rings()[0].offer(ring.attached());
  std::uint64_t refused = 0;
  for (const Case& wrong : cases) {
    spm_shared_command command = good_command(wrong.kind, 1);
    wrong.spoil(command);
    ring.write(command);
    REQUIRE(state->take(1000).empty());
    REQUIRE(ring.ring().refused == ++refused);
    REQUIRE(ring.ring().last_refused == refused);
    REQUIRE(ring.ring().last_refusal == static_cast<std::uint64_t>(wrong.refusal));
  }
  REQUIRE(state->counters().refused == refused);
  ring.write(move_command(0, 0.2));
  REQUIRE(state->take(1000).size() == 1);
}

TEST_CASE("What a command does not give is not looked at") {
  const auto state = small_state();
  RawRing ring(1);
  state->rings()[0].offer(ring.attached());
  spm_shared_command command = good_command(SPM_COMMAND_MATERIAL, 1);
  command.fields = SPM_MATERIAL_DAMPING;
  command.stiffness = std::nan("");
  ring.write(command);
  const auto taken = state->take(1);
  REQUIRE(taken.size() == 1);
  REQUIRE(taken[0].material.given == SPM_MATERIAL_DAMPING);
}

TEST_CASE("Every refusal has a sentence of its own") {
  std::set<std::string> sentences;
  for (std::size_t i = 0; i < refusal_count; ++i) {
    sentences.insert(to_sentence(static_cast<Refusal>(i)));
  }
  REQUIRE(sentences.size() == refusal_count);
  REQUIRE_FALSE(std::string(to_sentence(static_cast<Refusal>(200))).empty());
}

TEST_CASE("Random bytes in a ring are counted, bounded, and never come out as a wrong number") {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Random random(seed);
    const auto state = small_state();
    RawRing ring(9);
    state->rings()[static_cast<std::size_t>(seed % SPM_MAX_CLIENTS)].offer(ring.attached());
    for (int round = 0; round < 20; ++round) {
      for (spm_shared_command& slot : ring.ring().slots) {
        for (std::size_t word = 0; word < sizeof slot / 8; ++word) {
          reinterpret_cast<std::uint64_t*>(&slot)[word] = random.next();
        }
        // In many commands, only the numbers are wrong.
        if (random.next() % 2 == 0) slot.kind = 1 + static_cast<std::uint32_t>(random.next() % 5);
        if (random.next() % 2 == 0) slot.sequence = ring.ring().tail + 1 + random.next() % 4;
      }
      ring.ring().head = random.next() % 2 == 0 ? random.next() : ring.ring().head + 10;
      ring.ring().tail = random.next();
      const auto taken = state->take(0);
      REQUIRE(taken.size() <= AppState::max_of_client);
      for (const AppCommand& command : taken) {
        REQUIRE(command.pose.position.allFinite());
        REQUIRE(command.pose.position.cwiseAbs().maxCoeff() <= app_farthest);
        REQUIRE(std::abs(command.pose.rotation.norm() - 1) < 1e-9);
        REQUIRE(command.index < 1);
      }
    }
    const AppCounters counters = state->counters();
    REQUIRE(counters.garbage + counters.refused + counters.taken > 0);
  }
}

TEST_CASE("A ring that was spoilt works again once its client writes well") {
  const auto state = small_state();
  RawRing ring(1);
  state->rings()[0].offer(ring.attached());
  ring.write(move_command(0, 0.1));
  REQUIRE(state->take(0).size() == 1);
  // The head is far beyond the ring: everything up to it is dropped.
  store_release(ring.ring().head, std::uint64_t{1'000'000});
  REQUIRE(state->take(0).empty());
  REQUIRE(ring.ring().tail == 1'000'000);
  REQUIRE(ring.ring().garbage == 1);
  spm_shared_command command = move_command(0, 0.3);
  command.sequence = 1'000'001;
  store_record(ring.ring().slots[1'000'000 % SPM_RING_SLOTS], command);
  store_release(ring.ring().head, std::uint64_t{1'000'001});
  REQUIRE(state->take(0).size() == 1);
}

}  // namespace app_command_test
