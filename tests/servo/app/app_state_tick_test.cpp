// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <thread>
#include <vector>

#include "servo/app/app_scene.hpp"
#include "servo/app/app_state.hpp"
#include "servo/app/pose_interpolator.hpp"
#include "servo/realtime/page_faults.hpp"
#include "tests/servo/support/intercepted_calls.hpp"
#include "tests/servo/support/loop_stand_in.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace app_state_tick_test {

using namespace spm;
using namespace spm::servo;

TEST_CASE("What a tick does for applications neither allocates, locks, writes nor faults a page") {
  const auto state = test::small_state();
  test::RawRing ring(1);
  state->rings()[0].offer(ring.attached());
  const std::vector<AppDevice> devices(SPM_MAX_DEVICES, test::device_of(1));
  const std::vector<AppObject> objects(SPM_MAX_OBJECTS, test::object_of(1, 1));
  const std::vector<DeviceCounters> counted(SPM_MAX_DEVICES);
  PoseInterpolator interpolator({}, Placement());
  std::size_t taken = 0;
  const auto tick = [&](std::uint64_t number) {
    for (const AppCommand& command : state->take(static_cast<std::int64_t>(number))) {
      interpolator.give(command.pose, command.period, static_cast<std::int64_t>(number));
      state->refuse(command, Refusal::unknown_object);
      ++taken;
    }
    static_cast<void>(interpolator.at(static_cast<std::int64_t>(number)));
    state->publish({number, 0, devices, objects});
    state->count({1, 2, 3, number + 1, 0, 0, counted});
  };
  // The code itself comes into memory with the first ticks, as in the loop's warm-up.
  for (std::uint64_t number = 0; number < 4; ++number) {
    ring.write(test::move_command(0, 0));
    tick(number);
  }
  for (int i = 0; i < 200; ++i) ring.write(test::move_command(0, 0));
  const std::uint64_t faults = page_faults_of_this_thread();
  test::watch(true);
  const auto before = test::intercepted_calls();
  for (std::uint64_t number = 4; number < 1000; ++number) tick(number);
  const auto after = test::intercepted_calls();
  test::watch(false);
  REQUIRE(page_faults_of_this_thread() == faults);
  REQUIRE(taken == 204);
  REQUIRE(after.allocations == before.allocations);
  REQUIRE(after.locks == before.locks);
  REQUIRE(after.writes == before.writes);
}

TEST_CASE(
    "A tick with pushes and every effect neither allocates, locks, writes nor faults a page") {
  const auto state = test::small_state();
  test::RawRing ring(1);
  state->rings()[0].offer(ring.attached());
  const Asset box = test::box_asset(0.04);
  const AssetTables tables = tables_of(box);
  const std::vector<const AssetView*> assets{&tables.view()};
  const ForceScene scene = scene_of({});
  SceneForce force(scene, 1e-3, 1e-5);
  const std::vector<SceneForce*> forces{&force};
  AppScene app(*state, scene);
  app.effects().know_device(0, {1000, 5, 1000}, 1e-5, 1e-3, 1);
  double added = 0;
  const auto tick = [&](std::int64_t number) {
    static_cast<void>(app.begin(number, forces));
    const Vector3 tool(1e-5 * static_cast<double>(number % 100), 0, 0.0201);
    added += app.effects().next(0, tool, 1, number, force, assets).force.norm();
    if (number % 50 == 0) app.effects().rest(0);
  };
  const auto write = [&](std::uint32_t kind, std::uint32_t number) {
    spm_shared_command command = test::move_command(0, 0);
    command.kind = kind;
    command.effect_kind = 1 + number % 4;
    command.effect = number;
    command.stiffness = command.damping = 10;
    command.axis[0] = command.spacing = command.force[0] = 1;
    command.hold = 0.5;
    ring.write(command);
  };
  const auto write_all = [&] {
    for (std::uint32_t number = 0; number < 16; ++number) write(SPM_COMMAND_EFFECT, number);
    write(SPM_COMMAND_PUSH, 0);
    write(SPM_COMMAND_REMOVE_EFFECT, 3);
    write(SPM_COMMAND_EFFECT, 3);
  };
  write_all();
  for (std::int64_t number = 1; number < 200; ++number) tick(number);
  write_all();
  added = 0;
  const std::uint64_t faults = page_faults_of_this_thread();
  test::watch(true);
  const auto before = test::intercepted_calls();
  for (std::int64_t number = 200; number < 1000; ++number) tick(number);
  const auto after = test::intercepted_calls();
  test::watch(false);
  REQUIRE(page_faults_of_this_thread() == faults);
  REQUIRE(state->counters().refused == 0);
  REQUIRE(state->counters().taken == 38);
  REQUIRE(added > 100);
  REQUIRE(after.allocations == before.allocations);
  REQUIRE(after.locks == before.locks);
  REQUIRE(after.writes == before.writes);
}

}  // namespace app_state_tick_test
