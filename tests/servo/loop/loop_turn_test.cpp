// SPDX-License-Identifier: Apache-2.0
// A loop whose device turns: what is believed of it, and what it may not feel.
#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "common/base/turn_between.hpp"
#include "servo/loop/loop.hpp"
#include "tests/servo/support/scripted_device.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace loop_turn_test {

using namespace spm;
using namespace spm::servo;
using spm::test::ScriptedDevice;

namespace {

constexpr double half = 0.02;

Eigen::Quaterniond turned(double angle) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vector3(1, 2, 2) / 3));
}

/// A loop on a box of 40 mm in memory, run to its end on a hand that rests 1 mm inside the face +z
/// and turns as a test says.
struct TurningLoop {
  using Turn = std::function<void(std::size_t read, DeviceState& state, DeviceHealth& health)>;

  TurningLoop(std::uint64_t ticks, const Turn& turn) : TurningLoop(ticks, turn, {}) {}
  TurningLoop(std::uint64_t ticks, const Turn& turn, const DeviceCapabilities& can) {
    const Asset asset = test::box_asset(2 * half);
    const AssetTables tables = tables_of(asset);
    const ServedAsset served{&tables.view()};
    AssetSlot slot;
    slot.offer(&served);
    ScriptedDevice device([&](std::size_t read, DeviceState& state, DeviceHealth& health) {
      state.position = {0, 0, half - 1e-3};
      turn(read, state, health);
    });
    device.can().clutch_button = can.clutch_button;
    std::atomic<bool> stop{false};
    device.end_after(ticks, stop);
    TickRing ring = make_tick_ring(1000, 1);
    Loop loop(LoopSettings{}, {&device}, {&slot}, ring, stop);
    loop.run();
    counters = loop.device_counters(0);
    forces = device.forces();
    torques = device.torques();
    TickRecord record;
    while (ring.try_dequeue(record)) records.push_back(record);
  }
  [[nodiscard]] std::uint64_t off(ForceOff cause) const {
    return counters.force_off[static_cast<std::size_t>(cause)];
  }

  DeviceCounters counters;
  std::vector<Vector3> forces, torques;
  std::vector<TickRecord> records;
};

}  // namespace

TEST_CASE("An orientation that is no number, or not of unit length, gives zero with its cause") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const TurningLoop loop(300, [&](std::size_t read, DeviceState& state, DeviceHealth&) {
    if (read >= 120 && read < 125) state.orientation = Eigen::Quaterniond(1, 0, nan, 0);
    if (read >= 125 && read < 130) state.orientation = Eigen::Quaterniond(0, 0, 0, 0);
    if (read >= 130 && read < 135) state.orientation = Eigen::Quaterniond(1.001, 0, 0, 0);
  });
  CHECK(loop.off(ForceOff::not_a_number) == 15);
  CHECK(loop.forces[119].norm() > 0.5);
  for (std::size_t i = 120; i < 135; ++i) CHECK(loop.forces[i] == Vector3::Zero());
  CHECK(loop.forces[135].norm() < 0.05);
  CHECK(loop.forces[250].norm() > 0.5);
  CHECK(std::isfinite(loop.counters.energy));
}

TEST_CASE("A hand that turns by 180 degrees in a tick has jumped, and its force fades in again") {
  const TurningLoop loop(300, [&](std::size_t read, DeviceState& state, DeviceHealth&) {
    state.orientation = turned(read < 150 ? 0 : 3.14159);
  });
  CHECK(loop.off(ForceOff::jumped) == 1);
  CHECK(loop.forces[150] == Vector3::Zero());
  CHECK(loop.forces[151].norm() < 0.05);
  CHECK(loop.forces[280].norm() > 0.8);
}

TEST_CASE(
    "A hand that turns as fast as a wrist, and a quaternion that changes sign, are believed") {
  const TurningLoop loop(300, [&](std::size_t read, DeviceState& state, DeviceHealth&) {
    state.orientation = turned(0.025 * static_cast<double>(read));
    if (read % 2 == 0) state.orientation.coeffs() = -state.orientation.coeffs();
  });
  CHECK(loop.off(ForceOff::jumped) == 0);
  CHECK(loop.forces[280].norm() > 0.8);
}

TEST_CASE("A device that tells nothing any more is still turned as it was") {
  const TurningLoop loop(250, [&](std::size_t read, DeviceState& state, DeviceHealth& health) {
    if (read < 200) {
      state.orientation = turned(0.5);
    } else {
      health = DeviceHealth::gone;
      state.position.setConstant(1);
    }
  });
  CHECK(loop.off(ForceOff::device_gone) >= 49);
  for (const TickRecord& record : loop.records) {
    REQUIRE(record.hand.orientation.coeffs() == turned(0.5).coeffs());
    REQUIRE(record.hand.position == Vector3(0, 0, half - 1e-3));
  }
}

TEST_CASE("While its clutch is held the hand turns freely and the tool stays as it was turned") {
  DeviceCapabilities can;
  can.clutch_button = 2;
  const TurningLoop loop(
      400,
      [&](std::size_t read, DeviceState& state, DeviceHealth&) {
        const double free = read < 150 ? 0 : std::min(100.0, static_cast<double>(read) - 150);
        state.orientation = turned(0.01 * free);
        state.buttons = read >= 150 && read < 260 ? 2 : 0;
      },
      can);
  CHECK(loop.off(ForceOff::clutched) == 110);
  CHECK(loop.off(ForceOff::jumped) == 0);
  for (const std::size_t tick : {100U, 200U, 255U, 300U, 390U}) {
    CHECK(turn_between(turned(0), loop.records[tick].hand.orientation).norm() < 1e-12);
  }
  CHECK(loop.forces[390].norm() > 0.8);
}

TEST_CASE("To a device without torque none is ever sent") {
  const TurningLoop loop(200, [&](std::size_t, DeviceState& state, DeviceHealth&) {
    state.orientation = turned(0.3);
  });
  for (const Vector3& torque : loop.torques) REQUIRE(torque == Vector3::Zero());
  CHECK(loop.counters.torque_max == 0);
}

}  // namespace loop_turn_test
