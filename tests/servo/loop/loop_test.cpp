// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/loop.hpp"

#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <limits>
#include <thread>

#include "servo/base/clock.hpp"
#include "servo/devices/base/port.hpp"
#include "tests/servo/support/scripted_device.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace loop_test {

using namespace spm;
using namespace spm::servo;
using spm::test::ScriptedDevice;

namespace {

constexpr double half = 0.02;

/// A loop on a box of 40 mm in memory, run to its end.
class LoopOnBox {
 public:
  LoopOnBox() : asset_(test::box_asset(2 * half)), tables_(tables_of(asset_)) {
    served_.view = &tables_.view();
    slot_.offer(&served_);
  }

  void run(ScriptedDevice& device, std::uint64_t ticks) {
    stop_.store(false);
    if (ticks > 0) device.end_after(ticks, stop_);
    Loop loop(settings, {&device}, {&slot_}, ring_, stop_);
    loop.run();
    counters = loop.counters();
    device_counters = loop.device_counters(0);
    records.clear();
    TickRecord record;
    while (ring_.try_dequeue(record)) records.push_back(record);
  }

  [[nodiscard]] AssetSlot& slot() { return slot_; }
  [[nodiscard]] std::atomic<bool>& stop() { return stop_; }
  [[nodiscard]] std::uint64_t off(ForceOff cause) const {
    return device_counters.force_off[static_cast<std::size_t>(cause)];
  }

  LoopSettings settings;
  LoopCounters counters;
  DeviceCounters device_counters;
  std::vector<TickRecord> records;

 private:
  Asset asset_;
  AssetTables tables_;
  TickRing ring_ = make_tick_ring(1000, 1);
  ServedAsset served_;
  AssetSlot slot_;
  std::atomic<bool> stop_{false};
};

/// Rests 1 mm inside the face +z.
void press(std::size_t, DeviceState& state, DeviceHealth&) { state.position = {0, 0, half - 1e-3}; }

}  // namespace

TEST_CASE("A pressed tool feels stiffness times depth once the soft start is over") {
  LoopOnBox loop;
  ScriptedDevice device(press);
  loop.run(device, 300);
  REQUIRE(loop.records.size() == loop.counters.ticks);
  const TickRecord& late = loop.records[loop.records.size() - 2];
  REQUIRE(late.contact);
  REQUIRE(late.depth == Approx(1e-3).epsilon(1e-4));
  REQUIRE(late.sent.force.z() == Approx(1.0).epsilon(1e-4));
  REQUIRE(loop.device_counters.force_max == Approx(1.0).epsilon(1e-4));
  REQUIRE(loop.device_counters.cap_hits == 0);
}

TEST_CASE("The force fades in from the first tick") {
  LoopOnBox loop;
  ScriptedDevice device(press);
  loop.run(device, 150);
  REQUIRE(device.forces().front().z() == Approx(1. / 150).epsilon(1e-3));
  for (std::size_t i = 1; i < 100; ++i) {
    REQUIRE(device.forces()[i].z() > device.forces()[i - 1].z());
  }
}

TEST_CASE("The last wrench sent is zero, after a duration and after a stop") {
  LoopOnBox loop;
  ScriptedDevice device(press);
  loop.run(device, 200);
  REQUIRE(device.forces()[device.forces().size() - 3].norm() > 0.5);
  REQUIRE(device.forces().back() == Vector3::Zero());
  REQUIRE(loop.off(ForceOff::stopping) == 1);

  ScriptedDevice stopped([&](std::size_t read, DeviceState& state, DeviceHealth& health) {
    press(read, state, health);
    if (read == 150) loop.stop().store(true);
  });
  loop.run(stopped, 0);
  REQUIRE(loop.counters.ticks == 152);
  REQUIRE(stopped.forces()[150].norm() > 0.5);
  REQUIRE(stopped.forces().back() == Vector3::Zero());
}

TEST_CASE("After a stall no tick is made up for: the loop goes on with the next one due") {
  LoopOnBox loop;
  ScriptedDevice device([](std::size_t read, DeviceState& state, DeviceHealth& health) {
    press(read, state, health);
    if (read == 5) std::this_thread::sleep_for(std::chrono::microseconds(10'500));
  });
  loop.run(device, 60);
  REQUIRE(loop.counters.skipped >= 10);
  REQUIRE(loop.counters.missed > loop.counters.skipped);
  for (std::size_t i = 1; i < loop.records.size(); ++i) {
    REQUIRE(loop.records[i].tick > loop.records[i - 1].tick);
  }
  for (const TickRecord& record : loop.records) REQUIRE(record.wake_ns >= 0);
  REQUIRE(loop.records[6].tick >= loop.records[5].tick + 11);
  const std::uint64_t last = loop.records.back().tick;
  REQUIRE(loop.counters.ticks + loop.counters.skipped >= last + 1);
}

TEST_CASE("After guards sent zero for a loop that stood still the force fades in again") {
  LoopOnBox loop;
  ScriptedDevice device([](std::size_t read, DeviceState& state, DeviceHealth& health) {
    press(read, state, health);
    if (read == 150) std::this_thread::sleep_for(std::chrono::nanoseconds(loop_stall_ns));
  });
  loop.run(device, 300);
  REQUIRE(loop.off(ForceOff::stalled) == 0);
  REQUIRE(device.forces()[150].z() > 0.5);

  ScriptedDevice guarded([](std::size_t read, DeviceState& state, DeviceHealth& health) {
    press(read, state, health);
    if (read == 150) std::this_thread::sleep_for(std::chrono::nanoseconds(loop_stall_ns));
  });
  guarded.can().guarded = true;
  loop.run(guarded, 300);
  REQUIRE(loop.off(ForceOff::stalled) >= 2);
  REQUIRE(guarded.forces()[150] == Vector3::Zero());
  REQUIRE(guarded.forces()[151] == Vector3::Zero());
  REQUIRE(guarded.forces()[152].z() < 0.05);
}

TEST_CASE(
    "A position that is not a number gives zero force with its cause, then the force is back") {
  LoopOnBox loop;
  ScriptedDevice device([](std::size_t read, DeviceState& state, DeviceHealth& health) {
    press(read, state, health);
    if (read >= 120 && read < 130) {
      state.position.y() = std::numeric_limits<double>::quiet_NaN();
    }
  });
  loop.run(device, 300);
  REQUIRE(loop.off(ForceOff::not_a_number) == 10);
  for (std::size_t i = 120; i < 130; ++i) REQUIRE(device.forces()[i] == Vector3::Zero());
  REQUIRE(device.forces()[119].norm() > 0.5);
  REQUIRE(device.forces()[130].norm() < 0.05);
  REQUIRE(device.forces()[250].norm() > 0.5);
  REQUIRE(std::isfinite(loop.device_counters.energy));
}

TEST_CASE("A device fault gives zero force with its cause") {
  LoopOnBox loop;
  ScriptedDevice device([](std::size_t read, DeviceState& state, DeviceHealth& health) {
    press(read, state, health);
    if (read >= 120 && read < 125) health = DeviceHealth::fault;
  });
  loop.run(device, 200);
  REQUIRE(loop.off(ForceOff::device_fault) == 5);
  for (std::size_t i = 120; i < 125; ++i) REQUIRE(device.forces()[i] == Vector3::Zero());
}

TEST_CASE("A device that tells nothing any more is still where it was") {
  LoopOnBox loop;
  ScriptedDevice device([](std::size_t read, DeviceState& state, DeviceHealth& health) {
    if (read < 200) {
      press(read, state, health);
    } else {
      health = DeviceHealth::gone;
    }
  });
  loop.run(device, 250);
  REQUIRE(loop.off(ForceOff::device_gone) >= 49);
  for (const TickRecord& record : loop.records) {
    REQUIRE(record.hand.position == Vector3(0, 0, half - 1e-3));
  }
  REQUIRE(loop.device_counters.energy == 0);
}

TEST_CASE("Samples that are not numbers never reach the device") {
  Asset asset = test::box_asset(2 * half);
  for (MapData& map : asset.maps) {
    map.samples.assign(map.samples.size(), std::numeric_limits<float>::quiet_NaN());
  }
  for (float& corner : asset.triangles) corner = std::numeric_limits<float>::quiet_NaN();
  const AssetTables tables = tables_of(asset);
  ServedAsset served{&tables.view()};
  for (const Method method : {Method::spm, Method::paper}) {
    AssetSlot slot;
    slot.offer(&served);
    TickRing ring = make_tick_ring(1000, 1);
    const std::atomic<bool> stop{false};
    ScriptedDevice device(press);
    LoopSettings settings;
    settings.ticks = 150;
    settings.scene.objects.front().force.method = method;
    Loop loop(settings, {&device}, {&slot}, ring, stop);
    loop.run();
    for (const Vector3& force : device.forces()) REQUIRE(force == Vector3::Zero());
  }
}

TEST_CASE("Without an asset the loop runs, with zero force and the cause starting") {
  LoopOnBox loop;
  loop.slot().offer(nullptr);
  ScriptedDevice device(press);
  loop.run(device, 50);
  REQUIRE(loop.off(ForceOff::starting) == loop.counters.ticks - 1);
  REQUIRE(loop.device_counters.force_max == 0);
}

TEST_CASE(
    "An asset that is taken away gives zero force at once, and a soft start when it is back") {
  LoopOnBox loop;
  const ServedAsset* asset = loop.slot().acquire();
  ScriptedDevice device([&](std::size_t read, DeviceState& state, DeviceHealth& health) {
    press(read, state, health);
    if (read == 150) loop.slot().offer(nullptr);
    if (read == 170) loop.slot().offer(asset);
  });
  loop.run(device, 320);
  REQUIRE(loop.off(ForceOff::asset_lost) == 20);
  // The exchange happens while tick 150 runs, so that the next one must know of it.
  for (std::size_t i = 151; i < 171; ++i) REQUIRE(device.forces()[i] == Vector3::Zero());
  REQUIRE(device.forces()[171].z() == Approx(1. / 150).epsilon(1e-3));
  REQUIRE(device.forces()[300].z() > 0.8);
}

TEST_CASE("A scene of two assets gives the sum, and no force while one of them is lost") {
  const Asset assets[2] = {test::box_asset(2 * half), test::box_asset(2 * half)};
  const AssetTables tables[2] = {tables_of(assets[0]), tables_of(assets[1])};
  const ServedAsset served[2] = {{&tables[0].view()}, {&tables[1].view()}};
  AssetSlot slots[2];
  for (int i = 0; i < 2; ++i) slots[i].offer(&served[i]);
  LoopSettings settings;
  settings.scene.objects.push_back(settings.scene.objects.front());
  settings.scene.objects[1].asset = 1;
  settings.scene.objects[1].force.stiffness = 500;
  TickRing ring = make_tick_ring(1000, 1);
  std::atomic<bool> stop{false};
  ScriptedDevice device([&](std::size_t read, DeviceState& state, DeviceHealth& health) {
    press(read, state, health);
    if (read == 200) slots[1].offer(nullptr);
    if (read == 250) slots[1].offer(&served[1]);
  });
  device.end_after(500, stop);
  Loop loop(settings, {&device}, {&slots[0], &slots[1]}, ring, stop);
  loop.run();
  REQUIRE(device.forces()[190].z() == Approx(1.5).epsilon(1e-4));
  for (std::size_t i = 201; i < 251; ++i) REQUIRE(device.forces()[i] == Vector3::Zero());
  REQUIRE(device.forces()[251].z() == Approx(1.5 / 150).epsilon(1e-3));
  REQUIRE(device.forces()[400].z() == Approx(1.5).epsilon(1e-4));
  REQUIRE(loop.device_counters(0).force_off[static_cast<std::size_t>(ForceOff::asset_lost)] == 50);
}

TEST_CASE("A scene's force cap holds in the loop beside the device's, after the sum") {
  const Asset asset = test::box_asset(2 * half);
  const AssetTables tables = tables_of(asset);
  const ServedAsset served{&tables.view()};
  AssetSlot slot;
  slot.offer(&served);
  LoopSettings settings;
  settings.force_cap = 1.2;
  settings.scene.objects.push_back(settings.scene.objects.front());
  TickRing ring = make_tick_ring(1000, 1);
  std::atomic<bool> stop{false};
  ScriptedDevice device(press);
  device.end_after(300, stop);
  Loop loop(settings, {&device}, {&slot}, ring, stop);
  loop.run();
  REQUIRE(loop.device_counters(0).force_max == Approx(1.2));
  REQUIRE(loop.device_counters(0).cap_hits > 100);
}

TEST_CASE("The force cap of the device holds in the loop") {
  LoopOnBox loop;
  ScriptedDevice device(press, 0.3);
  loop.run(device, 300);
  REQUIRE(loop.device_counters.cap_hits > 100);
  REQUIRE(loop.device_counters.force_max == Approx(0.3));
}

TEST_CASE("The energy counts the work of the forces sent: zero over a quiet press") {
  LoopOnBox loop;
  ScriptedDevice device(press);
  loop.run(device, 200);
  REQUIRE(loop.device_counters.energy == 0);
  REQUIRE(loop.device_counters.generated_max == 0);
}

TEST_CASE("A hand that is pushed out receives energy, one that pushes in gives it") {
  LoopOnBox loop;
  const auto ramp = [](double from, double to) {
    return [=](std::size_t read, DeviceState& state, DeviceHealth&) {
      const double share = read < 150 ? 0 : std::min(1.0, (static_cast<double>(read) - 150) / 100);
      state.position = {0, 0, half - from - share * (to - from)};
    };
  };
  ScriptedDevice out(ramp(1e-3, 0));
  loop.run(out, 300);
  // k d^2 / 2, and the sampling's share k d step / 2.
  REQUIRE(loop.device_counters.generated_max == Approx(0.5e-3).epsilon(0.03));
  ScriptedDevice in(ramp(0, 1e-3));
  loop.run(in, 300);
  REQUIRE(loop.device_counters.generated_max == 0);
  REQUIRE(loop.device_counters.energy == Approx(-0.5e-3).epsilon(0.03));
}

TEST_CASE("No object is felt stiffer than the device renders stably") {
  LoopOnBox loop;
  ScriptedDevice device(press);
  device.can().stiffness_cap = 400;
  loop.run(device, 300);
  REQUIRE(device.forces()[250].z() == Approx(0.4).epsilon(1e-4));
}

TEST_CASE(
    "Outside the device's workspace there is no force, with its cause, and then a soft start") {
  LoopOnBox loop;
  ScriptedDevice device([](std::size_t read, DeviceState& state, DeviceHealth& health) {
    press(read, state, health);
    // Too short a way to count as a jump: the tool drifts out and comes back.
    if (read >= 150 && read < 200) state.position.x() = 6e-3;
  });
  device.can().workspace = {4e-3, half, half};
  loop.run(device, 400);
  REQUIRE(loop.off(ForceOff::outside_workspace) == 50);
  REQUIRE(device.forces()[149].z() > 0.9);
  for (std::size_t i = 150; i < 200; ++i) REQUIRE(device.forces()[i] == Vector3::Zero());
  REQUIRE(device.forces()[200].z() == Approx(1. / 150).epsilon(1e-3));
}

TEST_CASE("While its clutch button is held the hand moves freely and the tool stays") {
  LoopOnBox loop;
  ScriptedDevice device([](std::size_t read, DeviceState& state, DeviceHealth& health) {
    press(read, state, health);
    if (read < 150) return;
    // Held, the hand goes 5 mm out of the surface, 50 um a tick; then it stays there.
    const double moved = 50e-6 * std::min(100.0, static_cast<double>(read) - 150);
    state.position.z() += moved;
    state.buttons = read < 260 ? 2 : 0;
  });
  device.can().clutch_button = 2;
  loop.run(device, 500);
  REQUIRE(loop.off(ForceOff::clutched) == 110);
  for (std::size_t i = 150; i < 260; ++i) REQUIRE(device.forces()[i] == Vector3::Zero());
  REQUIRE(loop.records[255].hand.position.z() == Approx(half - 1e-3).epsilon(1e-9));
  REQUIRE(device.forces()[450].z() == Approx(1).epsilon(1e-4));
}

TEST_CASE("Paced by its device the loop ticks once a report, and by the clock where none comes") {
  LoopOnBox loop;
  loop.settings.paced_by_device = true;
  std::vector<std::int64_t> times;
  ScriptedDevice timed([&](std::size_t read, DeviceState& state, DeviceHealth& health) {
    press(read, state, health);
    times.push_back(now_ns());
  });
  timed.report_every(1'250'000);
  loop.run(timed, 300);
  // 0.8 ticks a millisecond, however late single ones were.
  const double took = static_cast<double>(times.back() - times.front()) * 1e-9;
  REQUIRE(took >= 299 * 1.25e-3 * 0.99);
  REQUIRE(loop.records.size() == 300);

  ScriptedDevice silent(press);
  loop.run(silent, 100);
  REQUIRE(silent.forces()[50].z() > 0);
}

}  // namespace loop_test
