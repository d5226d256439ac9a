// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/base/port_threads.hpp"

#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <iostream>
#include <mutex>
#include <vector>

#include "tests/servo/devices/base/scripted_port.hpp"
#include "tests/servo/support/eventually.hpp"

namespace port_threads_test {

using namespace spm;
using namespace spm::servo;
using namespace spm::test;

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
  REQUIRE_FALSE(threads.take(report, came));  // it is older than the loss
  CHECK(threads.report_age().json_us().dump() == two);

  CHECK(threads.command_sent().json_us().dump() == nothing);
  REQUIRE(give_until_sent(threads, script, 1));
  REQUIRE(eventually([&] { return threads.command_sent().json_us().dump() != nothing; }));
  CHECK(threads.latency_us().at("command_sent").at("max").get<double>() > 0);
  // The command that answers a report is not sent where this test stood still; not each time.
  int next = 3;
  REQUIRE(eventually([&] {
    if (threads.report_to_command().json_us().at("p50") >= 5000) return true;
    bring_one(++next);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    REQUIRE(threads.take(report, came));
    REQUIRE(give_until_sent(threads, script, next));
    return false;
  }));
  const std::string answered = threads.report_to_command().json_us().dump();
  threads.give(2);  // answers no new report
  const auto sent_ns = now_ns();
  REQUIRE(eventually([&] { return now_ns() - sent_ns > 20'000'000; }));
  CHECK(threads.report_to_command().json_us().dump() == answered);
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

TEST_CASE("After a command that failed a device hears no force before it is opened again") {
  for (const int failing : {1, 2}) {
    CAPTURE(failing);
    Script script;
    Threads threads;
    REQUIRE(threads.start(opens(script), RealtimeMode::off));
    REQUIRE(give_until_sent(threads, script, 5));
    script.change([&] { script.failing_sends = failing; });
    threads.give(6);
    REQUIRE(eventually([&] { return threads.reopened() == 1; }));
    threads.end();
    const auto forced = std::find(script.sent.rbegin(), script.sent.rend(), 5).base();
    REQUIRE(forced != script.sent.end());
    const auto at = static_cast<std::size_t>(forced - script.sent.begin());
    CHECK(script.sent[at] == 0);
    CHECK(script.sent_by[at] == 1);
    CHECK_FALSE(script.has_sent(6));
    std::cerr << "no force " << static_cast<double>(script.sent_ns[at] - script.failed_ns) * 1e-6
              << " ms after " << failing << " failed transfers\n";
  }
}

TEST_CASE("A device that cannot be read any longer hears no force before it is opened again") {
  Script script;
  Threads threads;
  REQUIRE(threads.start(opens(script), RealtimeMode::off));
  REQUIRE(give_until_sent(threads, script, 5));
  script.change([&] { script.loses_reading = true; });
  REQUIRE(eventually([&] { return threads.reopened() == 1; }));
  threads.end();
  const auto forced = std::find(script.sent.rbegin(), script.sent.rend(), 5).base();
  const auto at = static_cast<std::size_t>(forced - script.sent.begin());
  REQUIRE(at < script.sent.size());
  CHECK(script.sent[at] == 0);
  CHECK(script.sent_by[at] == 1);
}

TEST_CASE("A device that cannot be read any longer and never had a command hears none") {
  Script script;
  Threads threads;
  REQUIRE(threads.start(opens(script), RealtimeMode::off));
  script.change([&] { script.loses_reading = true; });
  REQUIRE(eventually([&] { return threads.reopened() == 1; }));
  threads.end();
  REQUIRE(script.sent.empty());
}

TEST_CASE("A loss is seen by the loop however soon the device was found again") {
  Script script;
  Threads threads;
  REQUIRE(threads.start(opens(script), RealtimeMode::off));
  CHECK(threads.look());
  script.change([&] { script.loses_reading = true; });
  REQUIRE(eventually([&] { return threads.reopened() == 1; }));
  REQUIRE(threads.is_open());
  CHECK_FALSE(threads.look());
  CHECK(threads.look());
}

TEST_CASE("What was made for a device before it was lost is not used after it was found again") {
  Script script;
  Threads threads;
  REQUIRE(threads.start(opens(script), RealtimeMode::off));
  REQUIRE(give_until_sent(threads, script, 5));
  script.change([&] { script.reports.push_back(1); });
  REQUIRE(script.wait([&] { return script.reports.empty(); }));
  script.change([&] { script.loses_reading = true; });
  REQUIRE(eventually([&] { return threads.reopened() == 1; }));
  int report = 0;
  std::int64_t came = 0;
  CHECK_FALSE(threads.take(report, came));
  // The loop did not look since.
  threads.give(6);
  REQUIRE(give_until_sent(threads, script, 7));
  threads.end();
  CHECK_FALSE(script.has_sent(6));
}

TEST_CASE("A lost device is looked for at once, and then less and less often") {
  Script script;
  Threads threads;
  std::mutex mutex;
  std::vector<std::int64_t> tried_ns;
  const auto open = opens(script);
  REQUIRE(threads.start(
      [&](const std::atomic<bool>& stop) {
        const std::lock_guard lock(mutex);
        tried_ns.push_back(now_ns());
        return open(stop);
      },
      RealtimeMode::off));
  const std::int64_t lost_ns = now_ns();
  script.change([&] { script.plugged_in = false; });
  const auto tries = [&] {
    const std::lock_guard lock(mutex);
    return tried_ns.size();
  };
  REQUIRE(eventually([&] { return tries() >= 10; }));
  threads.end();
  // The first is the start's. A busy machine adds to each pause, but takes nothing from it.
  std::vector<std::int64_t> pauses;
  for (std::size_t i = 2; i < 10; ++i) pauses.push_back(tried_ns[i] - tried_ns[i - 1]);
  std::int64_t least = std::chrono::nanoseconds(Threads::first_retry).count();
  for (const std::int64_t pause : pauses) {
    CHECK(pause >= least);
    least = std::min<std::int64_t>(least * 3 / 2,
                                   std::chrono::nanoseconds(Threads::longest_retry).count());
  }
  std::cerr << "a lost device is looked for " << static_cast<double>(tried_ns[1] - lost_ns) * 1e-6
            << " ms after the loss\n";
}

TEST_CASE("A device that comes and goes is not opened again without pauses") {
  Script script;
  Threads threads;
  REQUIRE(threads.start(opens(script), RealtimeMode::off));
  const std::int64_t began = now_ns();
  for (std::uint32_t round = 1; round <= 9; ++round) {
    script.change([&] { script.loses_reading = true; });
    REQUIRE(eventually([&] { return threads.reopened() == round; }));
  }
  // 0, 1, 1.5, 2.25 ... 17 ms.
  CHECK(now_ns() - began >= 49'000'000);
}

TEST_CASE("A lost device is looked for anew when a loop that stood still goes on") {
  Script script;
  Threads threads;
  std::mutex mutex;
  std::vector<std::int64_t> tried_ns;
  const auto open = opens(script);
  REQUIRE(threads.start(
      [&](const std::atomic<bool>& stop) {
        const std::lock_guard lock(mutex);
        tried_ns.push_back(now_ns());
        return open(stop);
      },
      RealtimeMode::off));
  const auto tries = [&] {
    const std::lock_guard lock(mutex);
    return tried_ns.size();
  };
  static_cast<void>(threads.look());
  script.change([&] { script.plugged_in = false; });
  // By then each pause is the longest.
  REQUIRE(eventually([&] { return tries() >= 17; }));
  const std::size_t before = tries();
  REQUIRE(eventually([&] {
    static_cast<void>(threads.look());
    return tries() >= before + 6;
  }));
  threads.end();
  // A busy machine makes some pauses longer, hardly all.
  std::int64_t shortest = std::chrono::nanoseconds(Threads::longest_retry).count();
  for (std::size_t i = before + 1; i < tried_ns.size(); ++i) {
    shortest = std::min(shortest, tried_ns[i] - tried_ns[i - 1]);
  }
  CHECK(shortest < std::chrono::nanoseconds(Threads::longest_retry).count() / 2);
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
