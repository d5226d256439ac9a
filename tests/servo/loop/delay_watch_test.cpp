// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/delay_watch.hpp"

#include <atomic>
#include <catch2/catch.hpp>
#include <limits>

#include "common/contact/stable_stiffness.hpp"
#include "servo/loop/loop.hpp"
#include "tests/servo/support/scripted_device.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace delay_watch_test {

using namespace spm;
using namespace spm::servo;

namespace {

constexpr double tick = 1e-3;

/// Counts of a device whose readings and commands are each under way for so long, ns.
DelayCounts counts(std::uint64_t readings, std::uint64_t each_ns) {
  return {readings, readings * each_ns, readings, readings * each_ns};
}

/// Ticks of a device with that delay, from those counts on; whether any changed what counts.
bool look(DelayWatch& watch, DelayCounts& at, std::uint64_t ticks, std::uint64_t each_ns) {
  bool changed = false;
  for (std::uint64_t i = 0; i < ticks; ++i) {
    ++at.readings, ++at.commands;
    at.age_ns += each_ns, at.sent_ns += each_ns;
    changed = watch.look(at) || changed;
  }
  return changed;
}

constexpr double half = 0.02;

/// A box of 40 mm under a hand 0.1 mm inside, felt as stiff as suits a Falcon whose delay is told.
struct Run {
  std::vector<TickRecord> records;
  LoopDelay delay;
};
Run run(std::uint64_t each_ns, bool follows, std::size_t ticks = 700) {
  const Asset asset = test::box_asset(2 * half);
  const AssetTables tables = tables_of(asset);
  const ServedAsset served{&tables.view()};
  AssetSlot slot;
  slot.offer(&served);
  TickRing ring = make_tick_ring(1000, 1);
  std::atomic<bool> stop{false};
  test::ScriptedDevice device([](std::size_t, DeviceState& state, DeviceHealth&) {
    state.position = {0, 0, half - 1e-4};
  });
  device.can().profile = find_device_profile("falcon");
  device.can().stiffness_cap = device.can().profile->stiffness_cap;
  device.tell_delays([each_ns](std::size_t read) { return counts(read, each_ns); });
  device.end_after(ticks, stop);
  LoopSettings settings;
  const double stiffness = stable_stiffness(*device.can().profile);
  settings.scene = scene_of({.method = Method::proxy, .stiffness = stiffness});
  settings.scene.objects.front().stiffness_chosen = true;
  settings.scene.stabilization = in_loop_of(*device.can().profile, recommended_stabilization);
  settings.scene.follows_delay = follows;
  Loop loop(settings, {&device}, {&slot}, ring, stop);
  loop.run();
  Run done;
  done.delay = loop.delay(0);
  TickRecord record;
  while (ring.try_dequeue(record)) done.records.push_back(record);
  return done;
}

/// The stiffness of the last tick with contact.
double felt(const Run& run) {
  const TickRecord& late = run.records[run.records.size() - 2];
  return late.sent.force.norm() / late.depth;
}

}  // namespace

TEST_CASE("Before anything was measured the delay is the device's own, or one tick") {
  CHECK(DelayWatch(tick, 0).counted() == 1);
  CHECK(DelayWatch(tick, 2.1e-3).counted() == 2.25);
  CHECK(DelayWatch(tick, 1).counted() == max_delay_ticks);
}

TEST_CASE("A longer delay counts after one window, with what the device adds by itself") {
  DelayWatch watch(tick, 0.5e-3);
  DelayCounts at;
  CHECK_FALSE(look(watch, at, DelayWatch::window - 1, 700'000));
  CHECK(watch.counted() == 1);
  CHECK(look(watch, at, 1, 700'000));
  CHECK(watch.measured() == Approx(1.9));
  CHECK(watch.counted() == 2);
}

TEST_CASE("A shorter delay counts only when it has stayed for a while") {
  DelayWatch watch(tick, 0);
  DelayCounts at;
  REQUIRE(look(watch, at, DelayWatch::window, 1'500'000));
  REQUIRE(watch.counted() == 3);
  CHECK_FALSE(look(watch, at, 7 * DelayWatch::window, 500'000));
  CHECK(watch.counted() == 3);
  CHECK(look(watch, at, DelayWatch::window, 500'000));
  CHECK(watch.counted() == 1);
  CHECK_FALSE(look(watch, at, 20 * DelayWatch::window, 500'000));
}

TEST_CASE("A device that tells of no delay keeps the one that it began with") {
  DelayWatch watch(tick, 1.5e-3);
  for (int i = 0; i < 1000; ++i) REQUIRE_FALSE(watch.look({}));
  CHECK(watch.counted() == 1.5);
}

TEST_CASE("The stiffness that was chosen for a device falls with the delay that is measured") {
  const DeviceProfile& falcon = *find_device_profile("falcon");
  const double usual = stable_stiffness(falcon);
  CHECK(felt(run(500'000, true)) == Approx(usual).epsilon(1e-3));
  const Run late = run(2'000'000, true);
  CHECK(late.delay.measured == Approx(4));
  CHECK(late.delay.counted == 4);
  const double share = stiffness_share(falcon.actuator_lag(), 4, tick);
  CHECK(share == Approx((1.5 + 0.7958) / (4.5 + 0.7958)).epsilon(1e-3));
  const double border = margin_below_border(falcon);
  CHECK(late.delay.stiffest == Approx(share * border).epsilon(1e-6));
  CHECK(felt(late) == Approx(share * border).epsilon(1e-3));
}

TEST_CASE("A scene that names its delay keeps its stiffness, whatever is measured") {
  const double usual = stable_stiffness(*find_device_profile("falcon"));
  CHECK(felt(run(2'000'000, false)) == Approx(usual).epsilon(1e-3));
}

}  // namespace delay_watch_test
