// SPDX-License-Identifier: Apache-2.0
// A loop whose scene has a tool with six degrees of freedom: a small cube in the hand, above a
// table.
#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <vector>

#include "common/base/turn_between.hpp"
#include "servo/loop/loop.hpp"
#include "tests/servo/support/scripted_device.hpp"
#include "tests/servo/support/served_tool_scene.hpp"

namespace loop_tool_test {

using namespace spm;
using namespace spm::servo;
using spm::test::ScriptedDevice;
using spm::test::ToolScene;

namespace {

constexpr double rest = ToolScene::tool_size / 2;

Eigen::Quaterniond turned(double angle) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vector3::UnitY()));
}

/// The loop, run to its end on a hand that does what a test says.
struct ToolLoopRun : test::ServedToolScene {
  using Script = std::function<void(std::size_t read, DeviceState& state, DeviceHealth& health)>;

  ToolLoopRun() {
    can.turns = true;
    can.torque_cap = 0.3;
    can.force_cap = 8;
    can.turn_step = 1e-5;
    can.turning_inertia = 1e-3;
  }

  void run(std::uint64_t ticks, const Script& script) {
    ScriptedDevice device(script, can.force_cap);
    device.can().turns = can.turns;
    device.can().torque_cap = can.torque_cap;
    device.can().turn_step = can.turn_step;
    device.can().turning_inertia = can.turning_inertia;
    device.can().clutch_button = can.clutch_button;
    std::atomic<bool> stop{false};
    device.end_after(ticks, stop);
    LoopSettings settings;
    settings.scene = world.scene;
    settings.tick_budget = 50;  // no time decides anything here
    TickRing ring = make_tick_ring(1000, 1);
    Loop loop(settings, {&device}, places(), ring, stop);
    loop.run();
    counters = loop.device_counters(0);
    forces = device.forces();
    torques = device.torques();
    records.clear();
    TickRecord record;
    while (ring.try_dequeue(record)) records.push_back(record);
  }

  DeviceCapabilities can;
  DeviceCounters counters;
  std::vector<Vector3> forces, torques;
  std::vector<TickRecord> records;
};

/// Goes down to 2 mm inside the table within 100 ticks, and turns by `angle` within the next 100.
ToolLoopRun::Script press_and_turn(double angle) {
  return [angle](std::size_t read, DeviceState& state, DeviceHealth&) {
    const double down = std::min(1.0, static_cast<double>(read) / 100);
    const double turn = std::clamp((static_cast<double>(read) - 100) / 100, 0.0, 1.0);
    state.position = {0, 0, rest + 0.001 - 0.003 * down};
    state.orientation = turned(angle * turn);
  };
}

}  // namespace

TEST_CASE("A hand that presses its tool on a table and turns it feels force and torque") {
  ToolLoopRun loop;
  loop.run(400, press_and_turn(0.1));
  const TickRecord& late = loop.records[350];
  CHECK(late.contact);
  CHECK(late.has_tool);
  CHECK(late.patches > 0);
  CHECK(late.sent.force.z() > 0.5);
  CHECK(late.sent.torque.y() < -1e-3);
  CHECK(loop.torques[350] == late.sent.torque);
  CHECK(loop.counters.torque_max > 1e-3);
  CHECK(loop.counters.torque_max <= 0.3);
  // The tool is held back: higher than the hand would have it, and turned less.
  CHECK(late.tool.position.z() > late.hand.position.z() + 1e-3);
  CHECK(turn_between(late.tool.orientation, late.hand.orientation).norm() > 0.01);
  CHECK(loop.records[20].patches == 0);
}

TEST_CASE("The scene's torque cap holds beside the device's") {
  ToolLoopRun loop;
  loop.world.scene.tool->torque_cap = 0.004;
  loop.run(400, press_and_turn(0.4));
  CHECK(loop.counters.torque_max > 0.0005);
  CHECK(loop.counters.torque_max <= 0.004 * (1 + 1e-12));
  for (const Vector3& torque : loop.torques) REQUIRE(torque.norm() <= 0.004 * (1 + 1e-12));
}

TEST_CASE(
    "A device that reads turns and gives no torque is sent none, and its tool turns all the same") {
  ToolLoopRun loop;
  loop.can.torque_cap = 0;
  loop.run(400, press_and_turn(0.1));
  for (const Vector3& torque : loop.torques) REQUIRE(torque == Vector3::Zero());
  for (const TickRecord& record : loop.records) REQUIRE(record.wanted.torque == Vector3::Zero());
  CHECK(loop.forces[350].z() > 0.5);
  CHECK(loop.records[350].has_tool);
}

TEST_CASE(
    "A clutch holds the tool in place and turn, whatever the hand does, and no force is sent") {
  ToolLoopRun loop;
  loop.can.clutch_button = 1;
  const auto press = press_and_turn(0.05);
  loop.run(700, [&](std::size_t read, DeviceState& state, DeviceHealth& health) {
    press(read, state, health);
    if (read < 300) return;
    const double free = std::min(1.0, (static_cast<double>(read) - 300) / 200);
    state.position.z() += 0.01 * free;
    state.orientation = turned(0.05 + 0.8 * free);
    state.buttons = read < 550 ? 1 : 0;
  });
  const HandPose before = loop.records[299].hand;
  for (std::size_t i = 300; i < 690; ++i) {
    REQUIRE((loop.records[i].hand.position - before.position).norm() < 1e-12);
    REQUIRE(turn_between(loop.records[i].hand.orientation, before.orientation).norm() < 1e-12);
    if (i >= 550) continue;
    REQUIRE(loop.forces[i] == Vector3::Zero());
    REQUIRE(loop.torques[i] == Vector3::Zero());
  }
  // Then it presses and turns the tool again; the contact begins anew, in the table.
  CHECK(loop.forces[690].z() > 0.5);
  CHECK(loop.torques[690].y() < -1e-3);
}

TEST_CASE("Without the tool's samples there is no force, and they are taken up with a soft start") {
  ToolLoopRun loop;
  const auto press = press_and_turn(0.05);
  loop.run(700, [&](std::size_t read, DeviceState& state, DeviceHealth& health) {
    press(read, state, health);
    if (read == 300) loop.slots[1].offer(nullptr);
    if (read == 320) loop.slots[1].offer(&loop.served[1]);
  });
  CHECK(loop.counters.force_off[static_cast<std::size_t>(ForceOff::asset_lost)] == 20);
  CHECK(loop.forces[290].z() > 0.5);
  for (std::size_t i = 301; i < 321; ++i) {
    REQUIRE(loop.forces[i] == Vector3::Zero());
    REQUIRE(loop.torques[i] == Vector3::Zero());
  }
  CHECK(loop.forces[321].norm() < 0.05);
  CHECK(loop.forces[600].z() > 0.5);
}

TEST_CASE("Samples that are exchanged under a pressed tool make no kick") {
  ToolLoopRun loop;
  ToolScene other;
  other.scene.tool->spacing = 0.0005;
  other.begin();
  const ServedAsset exchanged{&other.tool_cube.view, nullptr, other.sampled.get()};
  const auto press = press_and_turn(0.05);
  loop.run(600, [&](std::size_t read, DeviceState& state, DeviceHealth& health) {
    press(read, state, health);
    if (read == 300) loop.slots[1].offer(&exchanged);
  });
  const double before = loop.forces[299].norm();
  CHECK(before > 0.5);
  for (std::size_t i = 300; i < 590; ++i) {
    REQUIRE(loop.forces[i].norm() < 1.2 * before);
    REQUIRE((loop.forces[i] - loop.forces[i - 1]).norm() < 0.2 * before);
  }
  CHECK(loop.forces[590].norm() == Approx(before).epsilon(0.1));
}

TEST_CASE("What a tool gives back is what was put in: the loop's energy of force and torque") {
  ToolLoopRun loop;
  // Down, turn, turn back, up again: a hand that ends where it began got no energy.
  loop.run(2000, [](std::size_t read, DeviceState& state, DeviceHealth&) {
    const double t = static_cast<double>(read) / 2000;
    const double down = std::sin(3.14159265 * t), turn = std::sin(6.2831853 * t);
    state.position = {0, 0, rest + 0.001 - 0.003 * down};
    state.orientation = turned(0.15 * turn);
  });
  CHECK(loop.counters.torque_max > 1e-3);
  // J: two thousandths of a newton over a millimetre are noise of sampling.
  CHECK(loop.counters.generated_max < 1e-4);
  CHECK(loop.counters.energy < 1e-4);
}

}  // namespace loop_tool_test
