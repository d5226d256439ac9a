// SPDX-License-Identifier: Apache-2.0
// The rules of a tick where the hand holds a tool with six degrees of freedom.
#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <thread>

#include "servo/loop/loop.hpp"
#include "tests/servo/support/intercepted_calls.hpp"
#include "tests/servo/support/scripted_device.hpp"
#include "tests/servo/support/served_tool_scene.hpp"

namespace tool_tick_test {

using namespace spm;
using namespace spm::servo;
using spm::test::ScriptedDevice;

TEST_CASE("A tick with a tool neither allocates, locks nor writes") {
  for (const Method method : {Method::proxy, Method::spm}) {
    test::ServedToolScene held(method);
    ScriptedDevice device([&](std::size_t read, DeviceState& state, DeviceHealth&) {
      if (read == 0) test::watch(true);
      const double t = static_cast<double>(read) * 1e-3;
      state.position = {0.002 * std::sin(7 * t), 0, 0.006 - 0.002 * std::sin(11 * t)};
      state.orientation =
          Eigen::Quaterniond(Eigen::AngleAxisd(0.3 * std::sin(5 * t), Vector3(1, 2, 2) / 3));
    });
    device.can().turns = true;
    device.can().torque_cap = 0.3;
    device.can().turning_inertia = 1e-3;
    LoopSettings settings;
    settings.ticks = 2000;
    settings.scene = held.world.scene;
    TickRing ring = make_tick_ring(settings.rate_hz, 1);
    const std::atomic<bool> stop{false};
    Loop loop(settings, {&device}, held.places(), ring, stop);
    test::InterceptedCalls calls;
    std::thread thread([&] {
      const auto before = test::intercepted_calls();
      loop.run();
      test::watch(false);
      calls = test::intercepted_calls() - before;
    });
    thread.join();
    REQUIRE(loop.counters().contact_ticks > 300);
    CHECK(loop.device_counters(0).torque_max > 0);
    CHECK(calls.allocations == 0);
    CHECK(calls.locks == 0);
    CHECK(calls.writes == 0);
  }
}

}  // namespace tool_tick_test
