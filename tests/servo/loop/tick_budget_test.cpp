// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "servo/loop/loop.hpp"
#include "servo/loop/replay.hpp"
#include "servo/record/tick_record.hpp"
#include "tests/servo/support/scripted_device.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace tick_budget_test {

using namespace spm;
using namespace spm::servo;
using spm::test::ScriptedDevice;

namespace {

constexpr double half = 0.02;
constexpr std::size_t objects = 9;

/// A clock by which time is over whenever it was read so often; 0: never.
std::uint64_t over_every = 0, readings = 0;
std::int64_t fake_clock() noexcept {
  const bool over = over_every > 0 && ++readings % over_every == 0;
  return over ? std::numeric_limits<std::int64_t>::max() : 0;
}

/// Slides to and fro over the top of a box, now and then above it.
void slide(std::size_t read, DeviceState& state, DeviceHealth&) {
  const auto at = static_cast<double>(read);
  state.position = {0.01 * std::sin(at * 5e-3), 0.003, half - 4e-4 * std::sin(at * 0.02)};
}

struct Run {
  LoopCounters counters;
  std::array<DeviceCounters, 2> devices;
  Recording recording;
};

LoopSettings crowd() {
  LoopSettings settings;
  PlacedObject object = settings.scene.objects.front();
  object.force.method = Method::proxy;
  object.force.stiffness = 100;
  settings.scene.objects.assign(objects, object);
  settings.clock = fake_clock;
  return settings;
}

/// A loop with two devices on nine boxes in one place.
Run run_crowd(const AssetTables& tables, std::uint64_t time_over_every) {
  over_every = time_over_every;
  readings = 0;
  ServedAsset served;
  served.view = &tables.view();
  AssetSlot slot;
  slot.offer(&served);
  ScriptedDevice first(slide), second(slide);
  std::atomic<bool> stop{false};
  first.end_after(800, stop);
  TickRing ring = make_tick_ring(1000, 2);
  Loop loop(crowd(), {&first, &second}, {&slot}, ring, stop);
  loop.run();
  Run run{loop.counters(), {loop.device_counters(0), loop.device_counters(1)}, {}};
  run.recording.header.devices.resize(2);
  TickRecord record;
  while (ring.try_dequeue(record)) run.recording.rows.push_back(to_row(record));
  return run;
}

}  // namespace

TEST_CASE("With time enough no tick is degraded, and no row says so") {
  const Asset asset = test::box_asset(2 * half);
  const AssetTables tables = tables_of(asset);
  const Run run = run_crowd(tables, 0);
  CHECK(run.counters.degraded_ticks == 0);
  for (const RecordingRow& row : run.recording.rows) {
    REQUIRE((row.first == 0 && row.exact == 0 && row.held == 0 && row.shortened == 0));
  }
}

TEST_CASE("Degraded ticks are counted by device and kind, recorded, and replayed to the bit") {
  const Asset asset = test::box_asset(2 * half);
  const AssetTables tables = tables_of(asset);
  const Run run = run_crowd(tables, 5);
  CHECK(run.counters.degraded_ticks > 100);
  for (std::size_t device = 0; device < 2; ++device) {
    const DeviceCounters& counted = run.devices[device];
    std::uint64_t ticks = 0, held = 0, shortened = 0;
    for (const RecordingRow& row : run.recording.rows) {
      if (row.device != device) continue;
      ticks += row.held + row.shortened > 0 ? 1 : 0;
      held += row.held;
      shortened += row.shortened;
    }
    CHECK(counted.degraded_ticks == ticks);
    CHECK(counted.held == held);
    CHECK(counted.shortened == shortened);
    CHECK(held > 100);
    const RecordedTicks recorded = ticks_of(run.recording, device);
    ReplayOptions options;
    options.scene = crowd().scene;
    options.marks = recorded.marks;
    const std::array<const AssetView*, 1> assets{&tables.view()};
    const ReplayResult result = replay(assets, recorded.trajectory, options);
    CHECK(difference(result, recorded.wanted).ticks == 0);
    // It is the record that decides: without it other forces come out.
    for (ReplayMark& mark : options.marks) mark.effort = {};
    CHECK(difference(replay(assets, recorded.trajectory, options), recorded.wanted).ticks > 0);
  }
}

}  // namespace tick_budget_test
