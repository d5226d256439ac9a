// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/base/port_threads.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <condition_variable>
#include <deque>
#include <vector>

#include "servo/realtime/core_pinning.hpp"
#include "tests/servo/support/eventually.hpp"
#include "tests/support/skip.hpp"

namespace port_threads_test {

using namespace spm;
using namespace spm::servo;
using spm::test::eventually;

namespace {

/// What a test makes the scripted device do, and what it saw; shared with all of its ports.
struct Script {
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<int> reports;  ///< still to be received
  std::vector<int> sent;
  std::vector<std::int64_t> sent_ns;  ///< when
  bool plugged_in = true;
  bool can_send = true;
  bool holds_sending = false;  ///< a command that is sent waits as long as this is true
  int sends_begun = 0;
  int ports_open = 0;
  int opened = 0;

  template <class Change>
  void change(const Change& what) {
    {
      const std::lock_guard lock(mutex);
      what();
    }
    changed.notify_all();
  }

  /// Waits for what must come; the time only ends a test that has failed.
  template <class Condition>
  [[nodiscard]] bool wait(const Condition& condition) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, std::chrono::seconds(20), condition);
  }

  /// Called under the mutex, as conditions of `wait` are.
  [[nodiscard]] bool has_sent(int command) const {
    return std::find(sent.begin(), sent.end(), command) != sent.end();
  }
  [[nodiscard]] std::size_t zeros() const {
    return static_cast<std::size_t>(std::count(sent.begin(), sent.end(), 0));
  }
};

class ScriptedPort final : public Port<int, int> {
 public:
  explicit ScriptedPort(Script& script) : script_(script) {}
  ~ScriptedPort() override {
    script_.change([this] { --script_.ports_open; });
  }

  [[nodiscard]] Received receive(int& report) override {
    std::unique_lock lock(script_.mutex);
    script_.changed.wait_for(lock, port_wait,
                             [this] { return !script_.plugged_in || !script_.reports.empty(); });
    if (!script_.plugged_in) return Received::gone;
    if (script_.reports.empty()) return Received::nothing;
    report = script_.reports.front();
    script_.reports.pop_front();
    lock.unlock();
    script_.changed.notify_all();
    return Received::report;
  }

  [[nodiscard]] bool send(const int& command) override {
    bool done = false;
    script_.change([this] { ++script_.sends_begun; });
    if (!script_.wait([this] { return !script_.holds_sending; })) return false;
    script_.change([this, command, &done] {
      done = script_.can_send && script_.plugged_in;
      if (!done) return;
      script_.sent.push_back(command);
      script_.sent_ns.push_back(now_ns());
    });
    return done;
  }

 private:
  Script& script_;
};

using Threads = PortThreads<int, int>;

Threads::Open opens(Script& script) {
  return [&script](const std::atomic<bool>&) -> Result<std::unique_ptr<Port<int, int>>> {
    bool plugged_in = false;
    script.change([&] {
      plugged_in = script.plugged_in;
      if (!plugged_in) return;
      ++script.ports_open;
      ++script.opened;
    });
    if (!plugged_in) return fail(ExitCode::file_or_device, "not plugged in: plug it in");
    return std::unique_ptr<Port<int, int>>(std::make_unique<ScriptedPort>(script));
  };
}

/// Gives a command every millisecond, as a loop does, until it is sent: where this test itself
/// stands still for a while, no force is sent in place of a command.
[[nodiscard]] bool give_until_sent(Threads& threads, Script& script, int command) {
  return eventually([&] {
    threads.give(command);
    const std::lock_guard lock(script.mutex);
    return script.has_sent(command);
  });
}

}  // namespace

TEST_CASE("A device that cannot be opened is the opener's error, and no thread starts") {
  Script script;
  script.plugged_in = false;
  Threads threads;
  const auto started = threads.start(opens(script), RealtimeMode::off);
  REQUIRE_FALSE(started);
  REQUIRE(started.error().message == "not plugged in: plug it in");
  REQUIRE_FALSE(threads.is_open());
  threads.end();
}

TEST_CASE("The newest report is taken, once, with the time that it came") {
  Script script;
  Threads threads;
  const std::int64_t before = now_ns();
  REQUIRE(threads.start(opens(script), RealtimeMode::off));
  REQUIRE(threads.is_open());
  int report = 0;
  std::int64_t came = 0;
  REQUIRE_FALSE(threads.take(report, came));
  script.change([&] { script.reports = {1, 2, 3}; });
  REQUIRE(script.wait([&] { return script.reports.empty(); }));
  REQUIRE(eventually([&] { return threads.take(report, came) && report == 3; }));
  REQUIRE(came >= before);
  REQUIRE(came <= now_ns());
  REQUIRE_FALSE(threads.take(report, came));
}

TEST_CASE("A report that was not taken is not waited for, and one that was is") {
  Script script;
  Threads threads;
  REQUIRE(threads.start(opens(script), RealtimeMode::off));
  const std::int64_t soon = now_ns() + 30'000'000;
  REQUIRE_FALSE(threads.wait(soon));
  REQUIRE(now_ns() >= soon);
  const auto much_later = [] { return now_ns() + 20'000'000'000; };
  int report = 0;
  std::int64_t came = 0;
  for (int i = 1; i <= 200; ++i) {
    script.change([&] { script.reports.push_back(i); });
    REQUIRE(threads.wait(much_later()));
    REQUIRE(threads.wait(0));
    REQUIRE(threads.take(report, came));
    REQUIRE(report == i);
    REQUIRE_FALSE(threads.wait(0));
  }
}

TEST_CASE("Ages of reports and times of commands are counted, not those from before a loss") {
  Script script;
  Threads threads;
  REQUIRE(threads.start(opens(script), RealtimeMode::off));
  const std::string nothing = LatencyHistogram().json_us().dump();
  int report = 0;
  std::int64_t came = 0;
  const auto bring_one = [&](int value) {
    script.change([&] { script.reports.push_back(value); });
    REQUIRE(threads.wait(now_ns() + 20'000'000'000));
  };
  bring_one(1);
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  REQUIRE(threads.take(report, came));
  CHECK(threads.report_age().json_us().dump() == nothing);  // may have lain there for long

  bring_one(2);
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  REQUIRE(threads.take(report, came));
  CHECK(threads.report_age().json_us().at("p50").get<double>() >= 5000);
  const std::string two = threads.report_age().json_us().dump();

  bring_one(3);
  script.change([&] { script.plugged_in = false; });
  REQUIRE(eventually([&] { return !threads.is_open(); }));
  script.change([&] { script.plugged_in = true; });
  REQUIRE(eventually([&] { return threads.is_open(); }));
  REQUIRE(threads.take(report, came));
  CHECK(report == 3);
  CHECK(threads.report_age().json_us().dump() == two);

  CHECK(threads.command_sent().json_us().dump() == nothing);
  REQUIRE(give_until_sent(threads, script, 1));
  REQUIRE(eventually([&] { return threads.command_sent().json_us().dump() != nothing; }));
  CHECK(threads.latency_us().at("command_sent").at("max").get<double>() > 0);
  // The reports so far lay there since before an opening, or before another one.
  CHECK(threads.report_to_command().json_us().at("p50").get<double>() >= 5000);
  const std::string answered = threads.report_to_command().json_us().dump();
  threads.give(2);  // answers no new report
  const auto sent_ns = now_ns();
  REQUIRE(eventually([&] { return now_ns() - sent_ns > 20'000'000; }));
  CHECK(threads.report_to_command().json_us().dump() == answered);
}

TEST_CASE("A zero that is sent for a stalled loop is no command whose time counts") {
  Script script;
  Threads threads;
  REQUIRE(threads.start(opens(script), RealtimeMode::off));
  REQUIRE(give_until_sent(threads, script, 5));
  REQUIRE(script.wait([&] { return script.zeros() >= 2; }));
  threads.end();
  CHECK(threads.delays().commands == script.sent.size() - script.zeros());
}

TEST_CASE("A lost device is looked for without real-time priority, and why it is not found told") {
  Script script;
  Threads threads;
  std::atomic<int> tries{0}, realtime_tries{0};
  const auto open = opens(script);
  REQUIRE(threads.start(
      [&](const std::atomic<bool>& stop) {
        int policy = 0;
        sched_param parameters{};
        pthread_getschedparam(pthread_self(), &policy, &parameters);
        realtime_tries.fetch_add(policy == SCHED_OTHER ? 0 : 1);
        tries.fetch_add(1);
        return open(stop);
      },
      RealtimeMode::attempt));
  CHECK(threads.last_error().empty());
  script.change([&] { script.plugged_in = false; });
  REQUIRE(eventually([&] { return !threads.last_error().empty(); }));
  CHECK(threads.last_error() == "not plugged in: plug it in");
  script.change([&] { script.plugged_in = true; });
  REQUIRE(eventually([&] { return threads.is_open(); }));
  CHECK(threads.last_error().empty());
  CHECK(tries >= 3);
  CHECK(realtime_tries == 0);
}

TEST_CASE("A command that is given is sent, in order") {
  Script script;
  Threads threads;
  REQUIRE(threads.start(opens(script), RealtimeMode::off));
  for (int i = 1; i <= 50; ++i) {
    REQUIRE(give_until_sent(threads, script, i));
  }
  threads.end();
  // Zeros may lie between: they are sent when the loop is late.
  std::vector<int> sent = script.sent;
  sent.erase(std::remove(sent.begin(), sent.end(), 0), sent.end());
  REQUIRE(std::is_sorted(sent.begin(), sent.end()));
}

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
    const auto is_sent = [&] {
      const std::lock_guard lock(script.mutex);
      return script.has_sent(5);
    };
    do {
      given_ns = now_ns();
      threads.give(5);
      sleep_until(given_ns + 2'000'000);
    } while (!is_sent());
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

TEST_CASE("Before the first command nothing is sent") {
  Script script;
  Threads threads;
  REQUIRE(threads.start(opens(script), RealtimeMode::off));
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  threads.end();
  REQUIRE(script.sent.empty());
}

TEST_CASE("A lost device is closed, looked for, and opened again as soon as it is back") {
  Script script;
  Threads threads;
  REQUIRE(threads.start(opens(script), RealtimeMode::off));
  for (std::uint32_t round = 1; round <= 3; ++round) {
    script.change([&] { script.plugged_in = false; });
    REQUIRE(eventually([&] { return !threads.is_open(); }));
    REQUIRE(script.wait([&] { return script.ports_open == 0; }));
    script.change([&] { script.plugged_in = true; });
    REQUIRE(eventually([&] { return threads.is_open(); }));
    REQUIRE(threads.reopened() == round);
    script.change([&] { script.reports.push_back(static_cast<int>(100 + round)); });
    int report = 0;
    std::int64_t came = 0;
    REQUIRE(eventually([&] { return threads.take(report, came); }));
    REQUIRE(report == static_cast<int>(100 + round));
  }
  threads.end();
  REQUIRE(script.ports_open == 0);
  REQUIRE(script.opened == 4);
}

TEST_CASE("That a lost device was found is told before the device is used, until that is ended") {
  Script script;
  Threads threads;
  std::atomic<int> told{0}, used_before{0};
  threads.when_found_again([&] {
    // Reports wait since before the device was found.
    used_before += threads.is_open() || threads.reopened() != 0 ? 1 : 0;
    script.change([&] { used_before += script.reports.empty() ? 1 : 0; });
    ++told;
  });
  REQUIRE(threads.start(opens(script), RealtimeMode::off));
  const auto lose_and_find = [&] {
    script.change([&] { script.plugged_in = false; });
    REQUIRE(eventually([&] { return !threads.is_open(); }));
    script.change([&] {
      script.reports.push_back(1);
      script.plugged_in = true;
    });
    REQUIRE(eventually([&] { return threads.is_open(); }));
  };
  lose_and_find();
  REQUIRE(told == 1);
  REQUIRE(used_before == 0);
  threads.when_found_again(nullptr);
  lose_and_find();
  REQUIRE(told == 1);
}

TEST_CASE("A command that cannot be sent closes the device and has it opened again") {
  Script script;
  Threads threads;
  REQUIRE(threads.start(opens(script), RealtimeMode::off));
  script.change([&] { script.can_send = false; });
  threads.give(1);
  REQUIRE(eventually([&] { return !threads.is_open(); }));
  script.change([&] { script.can_send = true; });
  REQUIRE(eventually([&] { return threads.is_open(); }));
  REQUIRE(threads.reopened() == 1);
  REQUIRE(give_until_sent(threads, script, 2));
  threads.end();
  REQUIRE_FALSE(script.has_sent(1));
}

TEST_CASE("The last that a device hears is no force, and then it is closed") {
  for (int i = 1; i <= 50; ++i) {
    Script script;
    {
      Threads threads;
      REQUIRE(threads.start(opens(script), RealtimeMode::off));
      threads.give(i);
      threads.give(-i);
    }
    REQUIRE_FALSE(script.sent.empty());
    REQUIRE(script.sent.back() == 0);
    REQUIRE(script.ports_open == 0);
  }
}

TEST_CASE("A device that never had a command hears none at the end") {
  Script script;
  Threads threads;
  REQUIRE(threads.start(opens(script), RealtimeMode::off));
  threads.end();
  REQUIRE(script.sent.empty());
}

TEST_CASE("The threads end while the device is lost, and may be told to end twice") {
  Script script;
  Threads threads;
  REQUIRE(threads.start(opens(script), RealtimeMode::off));
  script.change([&] { script.plugged_in = false; });
  REQUIRE(eventually([&] { return !threads.is_open(); }));
  threads.give(1);
  threads.end();
  threads.end();
  REQUIRE_FALSE(threads.is_open());
  REQUIRE(script.ports_open == 0);
}

}  // namespace port_threads_test
