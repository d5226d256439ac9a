// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "servo/devices/base/port_threads.hpp"
#include "tests/servo/support/eventually.hpp"

namespace spm::test {

/// What a test makes the scripted device do, and what it saw; shared with all of its ports.
struct Script {
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<int> reports;  ///< still to be received
  std::vector<int> sent;
  std::vector<std::int64_t> sent_ns;  ///< when
  std::vector<int> sent_by;           ///< by which opening of the device, from 1
  std::int64_t failed_ns = 0;         ///< when the first of the failing sends failed
  bool plugged_in = true;
  bool can_send = true;
  int failing_sends = 0;       ///< so many of the next fail
  bool loses_reading = false;  ///< the next report fails although sending works
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

class ScriptedPort final : public servo::Port<int, int> {
 public:
  explicit ScriptedPort(Script& script) : script_(script) {}
  ~ScriptedPort() override {
    script_.change([this] { --script_.ports_open; });
  }

  [[nodiscard]] servo::Received receive(int& report) override {
    std::unique_lock lock(script_.mutex);
    script_.changed.wait_for(lock, servo::port_wait, [this] {
      return !script_.plugged_in || script_.loses_reading || !script_.reports.empty();
    });
    if (!script_.plugged_in || std::exchange(script_.loses_reading, false)) {
      return servo::Received::gone;
    }
    if (script_.reports.empty()) return servo::Received::nothing;
    report = script_.reports.front();
    script_.reports.pop_front();
    lock.unlock();
    script_.changed.notify_all();
    return servo::Received::report;
  }

  [[nodiscard]] bool send(const int& command) override {
    bool done = false;
    script_.change([this] { ++script_.sends_begun; });
    if (!script_.wait([this] { return !script_.holds_sending; })) return false;
    script_.change([this, command, &done] {
      done = script_.can_send && script_.plugged_in && script_.failing_sends == 0;
      if (script_.failing_sends > 0 && script_.failed_ns == 0) script_.failed_ns = servo::now_ns();
      script_.failing_sends -= script_.failing_sends > 0 ? 1 : 0;
      if (!done) return;
      script_.sent_by.push_back(script_.opened);
      script_.sent.push_back(command);
      script_.sent_ns.push_back(servo::now_ns());
    });
    return done;
  }

 private:
  Script& script_;
};

using Threads = servo::PortThreads<int, int>;

[[nodiscard]] inline Threads::Open opens(Script& script) {
  return [&script](const std::atomic<bool>&) -> Result<std::unique_ptr<servo::Port<int, int>>> {
    bool plugged_in = false;
    script.change([&] {
      plugged_in = script.plugged_in;
      if (!plugged_in) return;
      ++script.ports_open;
      ++script.opened;
    });
    if (!plugged_in) return fail(ExitCode::file_or_device, "not plugged in: plug it in");
    return std::unique_ptr<servo::Port<int, int>>(std::make_unique<ScriptedPort>(script));
  };
}

/// Gives a command every millisecond, as a loop does, until it is sent: where this test itself
/// stands still for a while, no force is sent in place of a command.
[[nodiscard]] inline bool give_until_sent(Threads& threads, Script& script, int command) {
  return eventually([&] {
    static_cast<void>(threads.look());
    threads.give(command);
    const std::lock_guard lock(script.mutex);
    return script.has_sent(command);
  });
}

}  // namespace spm::test
