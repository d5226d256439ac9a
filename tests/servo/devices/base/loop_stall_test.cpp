// SPDX-License-Identifier: Apache-2.0
#include <sched.h>
#include <sys/mman.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <string>
#include <thread>

#include "servo/devices/base/port_threads.hpp"
#include "servo/realtime/core_pinning.hpp"
#include "tests/servo/devices/base/scripted_port.hpp"
#include "tests/servo/support/eventually.hpp"
#include "tests/support/skip.hpp"

namespace loop_stall_test {

using namespace spm;
using namespace spm::servo;
using namespace spm::test;

TEST_CASE("A loop that stalls is followed by a command of none") {
  Script script;
  Threads threads;
  REQUIRE(threads.start(opens(script), RealtimeMode::off));
  REQUIRE(give_until_sent(threads, script, 5));
  REQUIRE(script.wait([&] { return script.sent.back() == 0; }));
}

TEST_CASE("A command that a loop gives after a stall is sent, even if no zero was sent by then") {
  const auto is_sent = [] {
    Script script;
    Threads threads;
    REQUIRE(threads.start(opens(script), RealtimeMode::off));
    script.change([&] { script.holds_sending = true; });
    threads.give(1);
    REQUIRE(script.wait([&] { return script.sends_begun != 0; }));
    std::this_thread::sleep_for(std::chrono::nanoseconds(3 * loop_stall_ns));
    threads.give(2);
    script.change([&] { script.holds_sending = false; });
    REQUIRE(script.wait([&] { return script.sent.size() >= 2; }));
    threads.end();
    return script.has_sent(2);
  };
  // This test itself may stand still after its command, but not each time.
  REQUIRE(eventually(is_sent));
}

TEST_CASE(
    "A loop that spins on the core of its device's threads is followed by a command of none") {
  // Longer than a guard needs, and shorter than the time that the kernel lets real time compute.
  constexpr std::int64_t spin_ns = 600'000'000;
  Script script;
  Threads threads;
  cpu_set_t cores;
  REQUIRE(sched_getaffinity(0, sizeof cores, &cores) == 0);
  unsigned core = 0;
  while (!CPU_ISSET(core, &cores)) ++core;
  std::int64_t given_ns = 0;
  bool real_time = false;
  std::thread loop([&] {
    const auto pinned = CorePinning::hold(core);
    REQUIRE(threads.start(opens(script), RealtimeMode::attempt));
    const auto entered = enter_realtime(RealtimeMode::attempt);
    real_time = entered && entered->policy == "fifo";
    REQUIRE(eventually([&] {
      given_ns = now_ns();
      threads.give(5);
      sleep_until(given_ns + 2'000'000);
      const std::lock_guard lock(script.mutex);
      return script.has_sent(5);
    }));
    if (real_time) {
      while (now_ns() < given_ns + spin_ns) {
      }
    }
  });
  loop.join();
  munlockall();
  if (!real_time) SPM_SKIP("no real-time priority may be had");
  threads.end();
  const auto last = std::find(script.sent.rbegin(), script.sent.rend(), 5).base();
  REQUIRE(last != script.sent.end());
  REQUIRE(*last == 0);
  const std::int64_t off_after_ns = script.sent_ns[last - script.sent.begin()] - given_ns;
  CAPTURE(off_after_ns);
  CHECK(off_after_ns < spin_ns / 2);
}

TEST_CASE("A zero that is sent for a stalled loop is no command whose time counts") {
  Script script;
  Threads threads;
  REQUIRE(threads.start(opens(script), RealtimeMode::off));
  REQUIRE(give_until_sent(threads, script, 5));
  // After the first zero the command's time is counted, and none is left to be sent.
  REQUIRE(script.wait([&] { return script.sent.back() == 0; }));
  const std::string once = threads.command_sent().json_us().dump();
  std::size_t before = 0;
  script.change([&] { before = script.zeros(); });
  REQUIRE(script.wait([&] { return script.zeros() >= before + 2; }));
  threads.end();
  CHECK(threads.command_sent().json_us().at("max") > 0);
  CHECK(threads.command_sent().json_us().dump() == once);
  CHECK(threads.delays().commands == script.sent.size() - script.zeros());
}

}  // namespace loop_stall_test
