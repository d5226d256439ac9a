// SPDX-License-Identifier: Apache-2.0
// What the loop's thread does to take up an edited scene.
#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <thread>

#include "servo/loop/loop.hpp"
#include "tests/servo/support/intercepted_calls.hpp"
#include "tests/servo/support/scripted_device.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace scene_edit_tick_test {

using namespace spm;
using namespace spm::servo;

TEST_CASE("A tick that takes up an edited scene neither allocates, locks nor writes") {
  constexpr double size = 0.04;
  constexpr std::size_t most = 40;
  const Asset asset = test::box_asset(size);
  const AssetTables tables = tables_of(asset);
  const ServedAsset served{&tables.view()};
  std::array<AssetSlot, 1 + spare_assets> slots;
  std::vector<AssetSlot*> all;
  all.reserve(slots.size());
  for (AssetSlot& slot : slots) all.push_back(&slot);
  slots[0].offer(&served);

  auto state = AppState::create(1000, {{"hand"}, {"box"}, {"box"}});
  REQUIRE(state);
  std::atomic<bool> stop{false};
  // The first read is inside a tick. Everything before it belongs to the loop's start-up.
  test::ScriptedDevice device([&](std::size_t read, DeviceState& hand, DeviceHealth&) {
    if (read == 0) test::watch(true);
    hand.position = {0, 0, size / 2 - 1e-3};
  });
  TickRing ring = make_tick_ring(1000, 1);
  SceneEditSlot edits;
  LoopSettings settings;
  Loop loop(settings, {&device}, all, ring, stop, state->get(), &edits);
  // All changes are recorded meanwhile.
  StepRing steps = make_step_ring();
  ChangeTeller changes_told(steps, SPM_MAX_OBJECTS);
  loop.tell_changes(changes_told);
  test::InterceptedCalls calls;
  std::thread thread([&] {
    const auto before = test::intercepted_calls();
    loop.run();
    test::watch(false);
    calls = test::intercepted_calls() - before;
  });

  const auto taken_up = [&edits](const SceneEdit& edit) {
    edits.offer(edit);
    while (edits.answer() == EditAnswer::none) std::this_thread::yield();
    return edits.answer() == EditAnswer::done;
  };
  PlacedObject object = settings.scene.objects.front();
  int done = 0;
  for (std::uint64_t round = 1; round <= 10; ++round) {
    SceneEdit grows, changes, shrinks;
    slots[round].offer(&served);
    object.asset = round;
    for (std::uint64_t id = 1; id <= most; ++id) grows.added.push_back({id, object, true});
    grows.assets = round + 1;
    object.force.stiffness += 10;
    for (std::uint64_t id = 0; id <= most; ++id)
      changes.changed.push_back({id, object, id % 2 > 0});
    changes.assets = round + 1;
    for (std::uint64_t id = 1; id <= most; ++id) shrinks.removed.push_back(id);
    shrinks.assets = round + 1;
    done += static_cast<int>(taken_up(grows)) + static_cast<int>(taken_up(changes)) +
            static_cast<int>(taken_up(shrinks));
  }
  // An edit that needs more room than there is gets refused as a whole.
  SceneEdit too_many;
  for (std::uint64_t id = 1; id <= 64; ++id) too_many.added.push_back({id, object, true});
  too_many.removed.clear();
  too_many.assets = 1;
  const bool refused = !taken_up(too_many);
  stop.store(true);
  thread.join();
  REQUIRE(done == 30);
  // 63 objects that are added, changed and removed in each round.
  REQUIRE(steps.size_approx() >= std::size_t{10} * 3 * most);
  REQUIRE(refused);
  REQUIRE(calls.allocations == 0);
  REQUIRE(calls.locks == 0);
  REQUIRE(calls.writes == 0);
  REQUIRE(loop.counters().contact_ticks > 0);
}

}  // namespace scene_edit_tick_test
