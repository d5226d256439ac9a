// SPDX-License-Identifier: Apache-2.0
// What a tick does once its cause is known: a page that is lost while a force is computed, the time
// of several devices, what the energy account is told, and effects of applications.
#include <algorithm>
#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "servo/app/app_state.hpp"
#include "servo/loop/loop.hpp"
#include "servo/loop/replay.hpp"
#include "servo/record/tick_record.hpp"
#include "tests/servo/support/loop_stand_in.hpp"
#include "tests/servo/support/scripted_device.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace loop_cause_test {

using namespace spm;
using namespace spm::servo;
using spm::test::ScriptedDevice;

namespace {

constexpr double half = 0.02;

/// Rests 1 mm inside the face +z.
void press(std::size_t, DeviceState& state, DeviceHealth&) { state.position = {0, 0, half - 1e-3}; }

std::vector<TickRecord> taken_from(TickRing& ring) {
  std::vector<TickRecord> records;
  TickRecord record;
  while (ring.try_dequeue(record)) records.push_back(record);
  return records;
}

/// Boxes in one place.
LoopSettings crowd(std::size_t objects) {
  LoopSettings settings;
  PlacedObject object = settings.scene.objects.front();
  object.force.method = Method::proxy;
  object.force.stiffness = 100;
  settings.scene.objects.assign(objects, object);
  return settings;
}

/// A file that is emptied when the clock is read the next time.
std::string to_cut;
std::int64_t cutting_clock() noexcept {
  if (!to_cut.empty()) {
    std::error_code ignored;
    std::filesystem::resize_file(to_cut, 0, ignored);
    to_cut.clear();
  }
  return 0;
}

/// A clock by which 0.4 of a period is over when a tick begins.
std::int64_t late_clock() noexcept { return now_ns() + 4'000'000; }

}  // namespace

TEST_CASE("An asset whose pages are lost while a force is computed gives none in that very tick") {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("box.spm.exr");
  test::write(test::shape_asset(test::box(Vector3::Constant(2 * half))), path);
  const auto mapped = MappedAsset::open(path);
  REQUIRE(mapped);
  ServedAsset served{&(*mapped)->view(), mapped->get()};
  AssetSlot slot;
  slot.offer(&served);
  constexpr std::size_t cut_at = 150;
  ScriptedDevice device([&](std::size_t read, DeviceState& state, DeviceHealth& health) {
    press(read, state, health);
    if (read == cut_at) to_cut = path;
  });
  std::atomic<bool> stop{false};
  device.end_after(200, stop);
  LoopSettings settings = crowd(9);
  settings.clock = cutting_clock;
  TickRing ring = make_tick_ring(1000, 1);
  Loop loop(settings, {&device}, {&slot}, ring, stop);
  loop.run();
  const std::vector<TickRecord> records = taken_from(ring);
  REQUIRE(records.size() == 200);
  REQUIRE(to_cut.empty());
  CHECK(records[cut_at - 1].cause == ForceOff::none);
  CHECK(records[cut_at - 1].sent.force.z() > 0.5);
  CHECK(records[cut_at].cause == ForceOff::asset_lost);
  CHECK(records[cut_at].wanted.force.isZero());
  CHECK(records[cut_at].sent.force.isZero());
  CHECK_FALSE(records[cut_at].contact);
}

TEST_CASE("The first of two devices takes no more than its half of the budget") {
  const Asset asset = test::box_asset(2 * half);
  const AssetTables tables = tables_of(asset);
  ServedAsset served;
  served.view = &tables.view();
  AssetSlot slot;
  slot.offer(&served);
  ScriptedDevice first(press), second(press);
  std::atomic<bool> stop{false};
  first.end_after(60, stop);
  LoopSettings settings = crowd(9);
  // A period of 10 ms, of which the first may have 3 and both 6.
  settings.rate_hz = 100;
  settings.tick_budget = 0.6;
  settings.clock = late_clock;
  TickRing ring = make_tick_ring(100, 2);
  Loop loop(settings, {&first, &second}, {&slot}, ring, stop);
  loop.run();
  std::size_t ticks = 0, degraded = 0;
  for (const TickRecord& record : taken_from(ring)) {
    // In the first tick none of the objects is known to be touched.
    if (record.device != 0 || !record.contact || record.tick < 5) continue;
    ++ticks;
    degraded += record.effort.degraded() ? 1 : 0;
  }
  REQUIRE(ticks > 30);
  CHECK(degraded == ticks);
}

TEST_CASE("The energy account is told what was sent under a cap, and a replay agrees to the bit") {
  const Asset asset = test::box_asset(2 * half);
  const AssetTables tables = tables_of(asset);
  ServedAsset served;
  served.view = &tables.view();
  AssetSlot slot;
  slot.offer(&served);
  // Presses to 1.5 mm and lets go, five times a second, with a slow and a fast part.
  ScriptedDevice device(
      [](std::size_t read, DeviceState& state, DeviceHealth&) {
        const double t = 1e-3 * static_cast<double>(read);
        state.position = {0, 0, half - 1.5e-3 * std::abs(std::sin(15 * t) * std::sin(4 * t))};
      },
      0.4);
  std::atomic<bool> stop{false};
  device.end_after(1200, stop);
  LoopSettings settings;
  settings.scene.stabilization.passivity = true;
  TickRing ring = make_tick_ring(1000, 2);
  Loop loop(settings, {&device}, {&slot}, ring, stop);
  loop.run();
  CHECK(loop.device_counters(0).cap_hits > 100);
  Recording recording;
  recording.header.devices.resize(1);
  for (const TickRecord& record : taken_from(ring)) recording.rows.push_back(to_row(record));
  const RecordedTicks recorded = ticks_of(recording, 0);
  ReplayOptions options;
  options.scene = settings.scene;
  options.marks = recorded.marks;
  const DeviceCapabilities& can = device.capabilities();
  options.encoder_step = can.encoder_step;
  options.limits = felt_limits(force_device(can), 1e-3);
  const std::array<const AssetView*, 1> assets{&tables.view()};
  CHECK(difference(replay(assets, recorded.trajectory, options), recorded.wanted).ticks == 0);
  // What was not sent makes a difference.
  for (ReplayMark& mark : options.marks) mark.sent.reset();
  CHECK(difference(replay(assets, recorded.trajectory, options), recorded.wanted).ticks > 20);
}

TEST_CASE("After a tick without force an effect of an application begins from nothing again") {
  const Asset asset = test::box_asset(2 * half);
  const AssetTables tables = tables_of(asset);
  ServedAsset served;
  served.view = &tables.view();
  AssetSlot slot;
  slot.offer(&served);
  constexpr std::size_t gone_at = 400, back_at = 420;
  ScriptedDevice device([](std::size_t read, DeviceState& state, DeviceHealth& health) {
    state.position = {0, 0, half + 0.01};
    if (read >= gone_at && read < back_at) health = DeviceHealth::silent;
  });
  std::atomic<bool> stop{false};
  device.end_after(700, stop);
  const auto state = test::small_state();
  test::RawRing application(5);
  state->rings()[0].offer(application.attached());
  spm_shared_command spring{};
  spring.kind = SPM_COMMAND_EFFECT;
  spring.effect = 1;
  spring.effect_kind = SPM_EFFECT_SPRING;
  spring.stiffness = 50;
  application.write(spring);
  TickRing ring = make_tick_ring(1000, 1);
  Loop loop({}, {&device}, {&slot}, ring, stop, state.get());
  loop.run();
  const std::vector<TickRecord> records = taken_from(ring);
  REQUIRE(records.size() == 700);
  const double pull = -50 * (half + 0.01);
  CHECK(records[gone_at - 1].added.force.z() == Approx(pull).epsilon(0.02));
  CHECK(records[gone_at].added.force.isZero());
  // By records, since the soft start would hide it.
  const auto back = std::find_if(records.begin() + back_at, records.end(),
                                 [](const auto& record) { return record.cause == ForceOff::none; });
  REQUIRE(back != records.end());
  CHECK(std::abs(back->added.force.z()) < 0.9 * std::abs(pull));
}

}  // namespace loop_cause_test
