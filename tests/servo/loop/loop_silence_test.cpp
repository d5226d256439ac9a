// SPDX-License-Identifier: Apache-2.0
// What is left of a contact after ticks without force: the side of the hand, and nothing else.
#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <functional>
#include <vector>

#include "servo/loop/loop.hpp"
#include "tests/servo/support/scripted_device.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace loop_silence_test {

using namespace spm;
using namespace spm::servo;
using spm::test::ScriptedDevice;

namespace {

constexpr double thick = 1e-3;                                             // m, of a plate
constexpr double pressed = 0.7e-3;                                         // m, past its middle
constexpr std::size_t touches = 40, loses = 300, finds = 330, ends = 600;  // ticks

/// A loop on a plate, stepped without a clock. Returns what was sent in each tick.
std::vector<TickRecord> felt(const ScriptedDevice::Script& script, LoopSettings settings = {}) {
  static const Asset asset = test::shape_asset(test::plate({0.02, 0.02, thick}));
  static const AssetTables tables = tables_of(asset);
  ServedAsset served{&tables.view()};
  AssetSlot slot;
  slot.offer(&served);
  TickRing ring = make_tick_ring(1000, 1);
  const std::atomic<bool> stop{false};
  settings.scene.objects.front().force.method = Method::proxy;
  settings.clock = []() noexcept { return std::int64_t{0}; };
  ScriptedDevice device(script);
  Loop loop(settings, {&device}, {&slot}, ring, stop);
  std::vector<TickRecord> records;
  for (std::size_t tick = 0; tick < ends; ++tick) {
    loop.step(tick, 1'000'000'000 + static_cast<std::int64_t>(tick) * 1'000'000);
    records.push_back(loop.record_of(0));
  }
  return records;
}

/// Comes from above, and presses past the middle of the plate.
void press(std::size_t read, DeviceState& state) {
  const double share = std::min(1.0, static_cast<double>(read) / touches);
  state.position = {1e-3, 1e-3, thick / 2 + 1e-3 - share * (1e-3 + pressed)};
}

std::size_t tick_of_sleep = 0;
std::size_t ticks_asked = 0;

}  // namespace

TEST_CASE("A hand past the middle of a plate is on its side after a short silence of its device") {
  const auto records = felt([](std::size_t read, DeviceState& state, DeviceHealth& health) {
    press(read, state);
    if (read >= loses && read < finds) health = DeviceHealth::silent;
  });
  REQUIRE(records[loses - 1].sent.force.z() == Approx(1000 * pressed).epsilon(1e-2));
  REQUIRE(records[loses].sent.force.isZero());
  REQUIRE(records[loses].cause == ForceOff::device_silent);
  for (std::size_t i = finds; i < ends; ++i) REQUIRE(records[i].sent.force.z() > 0);
  CHECK(records[ends - 1].sent.force.z() == Approx(1000 * pressed).epsilon(1e-2));
}

TEST_CASE("A hand that went farther than some millimetres in a silence begins anew") {
  const auto records = felt([](std::size_t read, DeviceState& state, DeviceHealth& health) {
    press(read, state);
    if (read >= loses && read < finds) health = DeviceHealth::silent;
    // It went round the plate, and presses from below.
    if (read >= finds) state.position = {1e-3 + 1.1 * kept_way, 1e-3, -thick / 2 + 0.2e-3};
  });
  CHECK(records[ends - 1].sent.force.z() == Approx(-1000 * 0.2e-3).epsilon(1e-2));
}

TEST_CASE("While the machine sleeps time stands still: on waking there is no force at first") {
  LoopSettings settings;
  tick_of_sleep = loses;
  ticks_asked = 0;
  settings.asleep = []() noexcept {
    return ticks_asked++ >= tick_of_sleep ? std::int64_t{3'600'000'000'000} : std::int64_t{0};
  };
  const auto records = felt(
      [](std::size_t read, DeviceState& state, DeviceHealth&) { press(read, state); }, settings);
  CHECK(records[loses - 1].sent.force.z() > 0.6);
  for (std::size_t i = loses; i < loses + 250; ++i) {
    REQUIRE(records[i].cause == ForceOff::stalled);
    REQUIRE(records[i].sent.force.isZero());
  }
  CHECK(records[loses + 251].cause == ForceOff::none);
  CHECK(records[loses + 251].sent.force.z() < 0.02);
}

TEST_CASE("A machine that slept before the loop began makes no stall") {
  LoopSettings settings;
  settings.asleep = []() noexcept { return std::int64_t{3'600'000'000'000}; };
  const auto records = felt(
      [](std::size_t read, DeviceState& state, DeviceHealth&) { press(read, state); }, settings);
  for (const TickRecord& record : records) REQUIRE(record.cause == ForceOff::none);
}

TEST_CASE("A fault while the clutch is held moves no tool, and makes no energy") {
  constexpr std::uint32_t button = 1;
  static const Asset asset = test::shape_asset(test::plate({0.02, 0.02, thick}));
  static const AssetTables tables = tables_of(asset);
  ServedAsset served{&tables.view()};
  AssetSlot slot;
  slot.offer(&served);
  TickRing ring = make_tick_ring(1000, 1);
  const std::atomic<bool> stop{false};
  LoopSettings settings;
  settings.clock = []() noexcept { return std::int64_t{0}; };
  ScriptedDevice device([](std::size_t read, DeviceState& state, DeviceHealth& health) {
    press(read, state);
    if (read < loses) return;
    // The clutch is held, and the hand goes 30 mm to the side; in between its device is silent.
    state.buttons = 1;
    state.position.x() += std::min(0.03, 5e-4 * static_cast<double>(read - loses));
    if (read >= loses + 100 && read < loses + 110) health = DeviceHealth::silent;
  });
  device.can().clutch_button = button;
  Loop loop(settings, {&device}, {&slot}, ring, stop);
  Vector3 tool = Vector3::Zero();
  double energy = 0;
  for (std::size_t tick = 0; tick < ends; ++tick) {
    loop.step(tick, 1'000'000'000 + static_cast<std::int64_t>(tick) * 1'000'000);
    if (tick == loses) {
      tool = loop.record_of(0).hand.position;
      energy = loop.device_counters(0).energy;
    }
    if (tick > loses) REQUIRE((loop.record_of(0).hand.position - tool).norm() < 1e-12);
  }
  CHECK(loop.device_counters(0).energy == Approx(energy).margin(1e-12));
}

}  // namespace loop_silence_test
