// SPDX-License-Identifier: Apache-2.0
// A loop with two devices whose tools touch, and its recording.
#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <vector>

#include "servo/loop/loop.hpp"
#include "servo/loop/replay.hpp"
#include "tests/servo/support/scripted_device.hpp"
#include "tests/servo/support/served_tool_scene.hpp"

namespace two_tools_loop_test {

using namespace spm;
using namespace spm::servo;
using spm::test::ScriptedDevice;
using spm::test::ToolScene;

namespace {

constexpr double rest = ToolScene::tool_size / 2;

/// A scene of a table and two tools, as a loop is served it.
struct Served {
  Served() {
    world.scene.more_tools = {*world.scene.tool};
    for (auto& tool : tools) {
      auto made = SampledTool::make(world.tool_cube.view, *world.scene.tool, 1,
                                    objects_to_meet(world.scene, 0));
      REQUIRE(made);
      tool = std::move(*made);
    }
    served[0] = {&world.table.view};
    served[1] = {&world.tool_cube.view, nullptr, tools[0].get(), {tools[0].get(), tools[1].get()}};
    for (std::size_t i = 0; i < slots.size(); ++i) slots[i].offer(&served[i]);
  }

  ToolScene world;
  std::array<std::unique_ptr<SampledTool>, 2> tools;
  std::array<ServedAsset, 2> served;
  std::array<AssetSlot, 2> slots;
};

/// A hand that comes from one side, presses against the other's tool, turns, and goes, again and
/// again; the second one is gone for a while.
ScriptedDevice::Script waving(double side) {
  return [side](std::size_t read, DeviceState& state, DeviceHealth& health) {
    const double t = 1e-3 * static_cast<double>(read);
    const double press = std::sin(6 * t) * std::sin(6 * t);
    state.position = {side * (rest + 0.002 - 0.004 * press), side * 0.001 * std::sin(9 * t),
                      rest + 0.001 * std::sin(4 * t)};
    state.orientation =
        Eigen::Quaterniond(Eigen::AngleAxisd(side * 0.2 * std::sin(5 * t), Vector3::UnitY()));
    if (side > 0 && read > 500 && read < 560) health = DeviceHealth::silent;
  };
}

}  // namespace

TEST_CASE("Two devices whose tools touch are served, and their recording replays to the bit") {
  Served scene;
  ScriptedDevice first(waving(-1), 8), second(waving(1), 8);
  for (ScriptedDevice* device : {&first, &second}) {
    device->can().turns = true;
    device->can().torque_cap = 0.3;
    device->can().turning_inertia = 1e-3;
  }
  std::atomic<bool> stop{false};
  first.end_after(1500, stop);
  LoopSettings settings;
  settings.scene = scene.world.scene;
  TickRing ring = make_tick_ring(1000, 2);
  Loop loop(settings, {&first, &second}, {&scene.slots[0], &scene.slots[1]}, ring, stop);
  loop.run();
  Recording recording;
  recording.header.devices.resize(2);
  TickRecord record;
  while (ring.try_dequeue(record)) recording.rows.push_back(to_row(record));
  std::array<std::size_t, 2> both{};
  for (const RecordingRow& row : recording.rows) {
    both[row.device] += std::abs(row.wanted[0]) > 0.3 ? 1 : 0;
  }
  CHECK(both[0] > 100);
  CHECK(both[1] > 100);

  const Served fresh;
  std::array<RecordedTicks, 2> ticks;
  std::array<ReplayOptions, 2> options;
  std::vector<ReplayHand> hands;
  for (std::size_t device = 0; device < 2; ++device) {
    ticks[device] = ticks_of(recording, device);
    options[device].scene = scene.world.scene;
    options[device].marks = ticks[device].marks;
    options[device].hand = device;
    options[device].tool = fresh.tools[device].get();
    const DeviceCapabilities& can = (device == 0 ? first : second).capabilities();
    options[device].encoder_step = can.encoder_step;
    options[device].limits = felt_limits(force_device(can), 1e-3);
    options[device].turning = turning_in_run(can, settings, device);
    hands.push_back({ticks[device].trajectory, ticks[device].ticks, &options[device]});
  }
  const std::vector<ReplayResult> results = replay_together(scene.world.assets, hands);
  for (std::size_t device = 0; device < 2; ++device) {
    CHECK(difference(results[device], ticks[device].wanted).ticks == 0);
    // Alone a hand would have felt another thing.
    const ReplayResult alone =
        replay(scene.world.assets, ticks[device].trajectory, options[device]);
    CHECK(difference(alone, ticks[device].wanted).ticks > 100);
  }
}

}  // namespace two_tools_loop_test
