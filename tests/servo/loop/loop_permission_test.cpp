// SPDX-License-Identifier: Apache-2.0
// What a person has to do before there is force: acknowledge a fault, hold the enable switch.
#include <atomic>
#include <catch2/catch.hpp>

#include "servo/loop/loop.hpp"
#include "tests/servo/support/scripted_device.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace loop_permission_test {

using namespace spm;
using namespace spm::servo;
using spm::test::ScriptedDevice;

namespace {

constexpr double half = 0.02;

/// What happened in the nth tick of a loop with a hand 1 mm inside a box of 40 mm.
struct Run {
  std::vector<TickRecord> records;
  std::vector<Vector3> forces;
};

Run run(const LoopSettings& settings, const ScriptedDevice::Script& script, std::size_t ticks) {
  const Asset asset = test::box_asset(2 * half);
  const AssetTables tables = tables_of(asset);
  const ServedAsset served{&tables.view()};
  AssetSlot slot;
  slot.offer(&served);
  TickRing ring = make_tick_ring(1000, 1);
  std::atomic<bool> stop{false};
  ScriptedDevice device([&script](std::size_t read, DeviceState& state, DeviceHealth& health) {
    state.position = {0, 0, half - 1e-3};
    script(read, state, health);
  });
  device.end_after(ticks, stop);
  Loop loop(settings, {&device}, {&slot}, ring, stop);
  loop.run();
  Run done;
  TickRecord record;
  while (ring.try_dequeue(record)) done.records.push_back(record);
  done.forces = device.forces();
  return done;
}

}  // namespace

TEST_CASE("After a fault the force stays off until a button is pressed, then it fades in") {
  LoopSettings settings;
  settings.acknowledge = true;
  const Run done = run(
      settings,
      [](std::size_t read, DeviceState& state, DeviceHealth& health) {
        if (read >= 120 && read < 130) health = DeviceHealth::silent;
        state.buttons = read >= 200 ? 1 : 0;
      },
      400);
  REQUIRE(done.forces[119].z() > 0.7);
  REQUIRE(done.records[125].cause == ForceOff::device_silent);
  for (std::size_t i = 120; i < 200; ++i) REQUIRE(done.forces[i] == Vector3::Zero());
  REQUIRE(done.records[130].cause == ForceOff::unacknowledged);
  REQUIRE(done.records[199].cause == ForceOff::unacknowledged);
  REQUIRE(done.records[200].cause == ForceOff::none);
  REQUIRE(done.forces[200].z() == Approx(1. / 150).epsilon(1e-3));
  REQUIRE(done.forces[360].z() > 0.9);
}

TEST_CASE("Without the option the force comes back by itself") {
  const Run done = run(
      {},
      [](std::size_t read, DeviceState&, DeviceHealth& health) {
        if (read >= 120 && read < 130) health = DeviceHealth::silent;
      },
      300);
  REQUIRE(done.records[130].cause == ForceOff::none);
  REQUIRE(done.forces[290].z() > 0.9);
}

TEST_CASE(
    "The enable switch lets the force fade in, and takes it away in the tick of its release") {
  LoopSettings settings;
  settings.enable_button = 2;
  const Run done = run(
      settings,
      [](std::size_t read, DeviceState& state, DeviceHealth&) {
        state.buttons = read >= 50 && read < 200 ? 0b10 : 0b01;
      },
      230);
  for (std::size_t i = 0; i < 50; ++i) REQUIRE(done.forces[i] == Vector3::Zero());
  REQUIRE(done.records[49].cause == ForceOff::not_enabled);
  REQUIRE(done.forces[50].z() == Approx(1. / 150).epsilon(1e-3));
  REQUIRE(done.forces[199].z() > 0.9);
  REQUIRE(done.forces[200] == Vector3::Zero());
  REQUIRE(done.records[200].cause == ForceOff::not_enabled);
}

}  // namespace loop_permission_test
