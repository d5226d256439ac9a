// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include "common/base/error.hpp"
#include "servo/base/clock.hpp"
#include "servo/devices/base/delay_counts.hpp"
#include "servo/devices/base/latency_histogram.hpp"
#include "servo/devices/base/latest_value.hpp"
#include "servo/devices/base/port.hpp"
#include "servo/devices/base/report_signal.hpp"
#include "servo/realtime/realtime.hpp"

namespace spm::servo {

/// Stands between the blocking calls of a device's connection and the loop, which must not wait.
/// One thread receives reports, and opens the device again when it was lost; another sends
/// commands. A device whose connection fails is sent `Command{}` before that is given up: one way
/// may fail while the other works. The loop takes the newest report and leaves the newest command;
/// each costs a few copies, and at most one wake-up of a thread. A third thread, above the loop in
/// priority, watches the loop: if it leaves no command for too long, the device is sent
/// `Command{}`, which must be no force, even where the loop spins on the only core that all these
/// threads may use.
template <class Report, class Command>
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding): that of LatestValue, which wants it.
class PortThreads {
 public:
  using DevicePort = Port<Report, Command>;
  /// Opens the device and makes it ready (which may take seconds), or says in a sentence why that
  /// failed. Called by `start`, and after a loss by a thread without real-time priority, while no
  /// other thread uses the device. It gives up soon after `stop` becomes true.
  using Open = std::function<Result<std::unique_ptr<DevicePort>>(const std::atomic<bool>& stop)>;

  /// A lost device is looked for at once, and then after pauses that grow by a half, from the first
  /// of these to the second. A loss soon after it was found goes on from there, so that one that
  /// comes and goes is not opened without a pause.
  static constexpr std::chrono::microseconds first_retry{1000}, longest_retry{200'000};
  static constexpr std::chrono::milliseconds settled_after{1000};
  /// How long after a failed transfer no force is sent, again and again, until that works.
  static constexpr std::chrono::milliseconds zero_within{5}, zero_pause{1};

  PortThreads() = default;
  PortThreads(const PortThreads&) = delete;
  PortThreads& operator=(const PortThreads&) = delete;
  ~PortThreads() { end(); }

  /// Opens the device and starts the threads. Errors: those of `open`.
  [[nodiscard]] Result<void> start(Open open, RealtimeMode realtime) {
    open_ = std::move(open);
    auto port = open_(stop_);
    if (!port) return tl::make_unexpected(std::move(port.error()));
    port_ = std::move(*port);
    open_now_.store(true);
    receiver_ = std::thread([this, realtime] {
      enter_device_thread(realtime);
      receive_all();
    });
    sender_ = std::thread([this, realtime] {
      enter_device_thread(realtime);
      send_all();
    });
    guard_ = std::thread([this, realtime] {
      enter_guard_thread(realtime);
      watch_loop();
    });
    return {};
  }

  /// Ends the threads. The last that a device hears is `Command{}`, unless it never had a command:
  /// what the loop asked for last may hold more than force, such as an arm's weight.
  void end() noexcept {
    if (!receiver_.joinable()) return;
    stop_.store(true);
    wake_sender();
    guard_.join();  // first, because it knows the other two
    sender_.join();
    receiver_.join();
    port_.reset();
    open_now_.store(false);
  }

  /// Called by the loop: the newest report and when it came (now_ns()), if one came since the last
  /// call, and since the device was last lost.
  [[nodiscard]] bool take(Report& report, std::int64_t& came_ns) noexcept {
    // A report that was there before the loop first looked says nothing about delays.
    const std::uint32_t opening = reopened() + 1;
    const bool begins = std::exchange(taken_opening_, opening) != opening;
    if (begins) newest_came_ns_ = 0;
    Stamped<Report> newest;
    if (!reports_.take(newest) || newest.opening + 1 != opening) {
      count_reading();
      return false;
    }
    report = newest.value;
    came_ns = newest.at_ns;
    if (begins) return true;
    newest_came_ns_ = came_ns;
    report_age_.add(count_reading());
    answered_ns_ = came_ns;
    return true;
  }

  /// Called by the loop: how long readings and commands were under way. A reading that several
  /// ticks use grows older.
  [[nodiscard]] DelayCounts delays() const noexcept {
    DelayCounts counts = read_;
    counts.commands = sent_.load(std::memory_order_relaxed);
    counts.sent_ns = sent_ns_.load(std::memory_order_relaxed);
    return counts;
  }

  /// Called by the loop: waits until there is a report that it did not take yet. False if none came
  /// until a time of now_ns().
  [[nodiscard]] bool wait(std::int64_t until_ns) noexcept {
    while (true) {
      const std::uint32_t seen = came_.count();
      if (reports_.is_fresh()) return true;
      if (!came_.wait(seen, until_ns)) return reports_.is_fresh();
    }
  }

  /// Called by the loop, first in a tick: whether the device is there, and was since the last call.
  /// So a loss is seen in one tick at least, however soon the device was found again.
  [[nodiscard]] bool look() noexcept {
    looked_ns_.store(now_ns(), std::memory_order_relaxed);
    const bool is_there = is_open();
    const std::uint32_t opening = reopened();
    return std::exchange(looked_opening_, opening) == opening && is_there;
  }

  /// Called by the loop: leaves a command for the sending thread. If that thread did not come to
  /// several commands, the last one is sent; none is where the device was lost, and perhaps found
  /// again, since the last `look`.
  void give(const Command& command) noexcept {
    const std::int64_t now = now_ns();
    commands_.put({command, now, std::exchange(answered_ns_, 0), looked_opening_});
    given_ns_.store(now, std::memory_order_relaxed);
    wake_sender();
  }

  /// Whether the device is there.
  [[nodiscard]] bool is_open() const noexcept { return open_now_.load(std::memory_order_acquire); }
  /// How often the device was opened again.
  [[nodiscard]] std::uint32_t reopened() const noexcept {
    return reopened_.load(std::memory_order_relaxed);
  }
  /// Has a function called whenever a lost device was found again, before it is used, by the thread
  /// that searches. Null: no longer, and no call is under way.
  void when_found_again(const std::function<void()>& tell) {
    const std::lock_guard lock(tell_mutex_);
    tell_ = tell;
  }
  /// Why the last attempt to open a lost device again failed. Empty if it did not fail, or none was
  /// lost.
  [[nodiscard]] std::string last_error() const {
    const std::lock_guard lock(error_mutex_);
    return last_error_;
  }

  /// Adds the last error to a description of the device, if there is one.
  void add_last_error(nlohmann::ordered_json& json) const {
    const std::string error = last_error();
    if (!error.empty()) json["last_error"] = error;
  }

  /// Time from the arrival of a report to when the loop took it.
  [[nodiscard]] const LatencyHistogram& report_age() const noexcept { return report_age_; }
  /// Time from when the loop gave a command to when the device had it.
  [[nodiscard]] const LatencyHistogram& command_sent() const noexcept { return command_sent_; }
  /// Time from the arrival of a report to when the device had the command that answers it. A report
  /// counts once, with the first command after it.
  [[nodiscard]] const LatencyHistogram& report_to_command() const noexcept {
    return report_to_command_;
  }
  /// All three, as a report of a run shows them.
  [[nodiscard]] nlohmann::ordered_json latency_us() const {
    return {{"report_age", report_age_.json_us()},
            {"command_sent", command_sent_.json_us()},
            {"report_to_command", report_to_command_.json_us()}};
  }

 private:
  template <class Value>
  struct Stamped {
    Value value{};
    std::int64_t at_ns = 0;
    std::int64_t answered_ns = 0;  ///< of a command: when the report came that it answers; 0: none
    std::uint32_t opening = 0;     ///< the opening of the device that it came from, or is for
  };

  /// Counts a reading that the loop uses now; its age, ns.
  std::int64_t count_reading() noexcept {
    if (newest_came_ns_ == 0) return 0;
    const std::int64_t age = std::max<std::int64_t>(0, now_ns() - newest_came_ns_);
    ++read_.readings;
    read_.age_ns += static_cast<std::uint64_t>(age);
    return age;
  }

  void wake_sender() noexcept {
    given_.fetch_add(1, std::memory_order_release);
    given_.notify_one();
  }

  void receive_all() {
    while (!stop_.load()) {
      if (broken_.load()) lose();
      if (port_ == nullptr) {
        open_again();
        continue;
      }
      Stamped<Report> stamped;
      switch (port_->receive(stamped.value)) {
        case Received::report:
          stamped.at_ns = now_ns();
          stamped.opening = reopened();
          reports_.put(stamped);
          came_.raise();
          break;
        case Received::nothing:
          break;
        case Received::gone:
          lose();
          break;
      }
    }
  }

  /// Sleeps until the loop would be too late with its next command.
  void watch_loop() {
    while (!stop_.load()) {
      const std::int64_t given = given_ns_.load(std::memory_order_relaxed);
      const std::int64_t now = now_ns();
      const bool stalls = given != 0 && now - given >= loop_stall_ns;
      raise(stalls);
      if (stalls) {
        stalled_since_ns_.store(given, std::memory_order_relaxed);
        wake_sender();
      }
      sleep_until((stalls || given == 0 ? now : given) + loop_stall_ns);
    }
    raise(false);
  }

  /// Both, because sending may wait for what the receiving thread holds.
  void raise(bool above) noexcept {
    if (above == raised_) return;
    raised_ = above;
    for (std::thread* thread : {&sender_, &receiver_}) {
      if (!above) {
        lower_below_loop(thread->native_handle());
      } else if (!raise_above_loop(thread->native_handle())) {
        raised_ = false;  // it has no real-time priority, and the loop then has none either
      }
    }
  }

  void lose() {
    open_now_.store(false, std::memory_order_release);
    const std::lock_guard lock(mutex_);
    // The sending thread has done so itself where it was sending that failed.
    if (!broken_.exchange(false) && given_ns_.load(std::memory_order_relaxed) != 0) send_zero();
    port_.reset();
    if (now_ns() - opened_ns_ >= std::chrono::nanoseconds(settled_after).count()) retry_ = {};
  }

  /// Called under the mutex: tries to send no force.
  void send_zero() {
    const std::int64_t until = now_ns() + std::chrono::nanoseconds(zero_within).count();
    while (!port_->send(Command{}) && now_ns() < until) std::this_thread::sleep_for(zero_pause);
  }

  /// Listing all that is plugged in takes milliseconds of a core, which the loop may need.
  void open_again() {
    try {
      std::thread([this] {
        leave_realtime();
        search();
      }).join();
    } catch (const std::system_error&) {
      // The system has no thread to spare now.
      std::this_thread::sleep_for(longest_retry);
    }
  }

  void search() {
    while (port_ == nullptr) {
      wait_before_search();
      if (stop_.load()) return;
      auto port = open_(stop_);
      {
        const std::lock_guard lock(error_mutex_);
        last_error_ = port ? std::string() : port.error().message;
      }
      if (!port) continue;
      tell_found();
      take_up(std::move(*port));
    }
  }

  /// A loop that goes on after it stood still need not wait: others had the device to end its
  /// force.
  void wait_before_search() {
    const std::int64_t until = now_ns() + std::chrono::nanoseconds(retry_).count();
    retry_ = std::clamp(retry_ * 3 / 2, first_retry, longest_retry);
    bool stood_still = false;
    for (std::int64_t now = now_ns(); now < until && !stop_.load(); now = now_ns()) {
      const std::int64_t looked = looked_ns_.load(std::memory_order_relaxed);
      const bool stands_still = looked != 0 && now - looked >= loop_stall_ns;
      if (std::exchange(stood_still, stands_still) && !stands_still) {
        retry_ = first_retry;
        return;
      }
      const std::chrono::nanoseconds most = stands_still ? 2 * first_retry : port_wait;
      std::this_thread::sleep_for(std::min(most, std::chrono::nanoseconds(until - now)));
    }
  }

  void tell_found() {
    const std::lock_guard lock(tell_mutex_);
    if (tell_) tell_();
  }

  void take_up(std::unique_ptr<DevicePort> port) {
    const std::lock_guard lock(mutex_);
    port_ = std::move(port);
    broken_.store(false);
    opened_ns_ = now_ns();
    reopened_.fetch_add(1, std::memory_order_relaxed);
    open_now_.store(true, std::memory_order_release);
  }

  void send_all() {
    std::uint32_t seen = 0;
    while (true) {
      const bool last = stop_.load();
      Stamped<Command> command;
      const std::int64_t stalled_ns = stalled_since_ns_.exchange(0, std::memory_order_relaxed);
      // A command from before the stall is not sent after it.
      bool is_given = commands_.take(command) && !last && command.at_ns > stalled_ns;
      const bool ends = last && given_ns_.load(std::memory_order_relaxed) != 0;
      if (is_given || stalled_ns != 0 || ends) {
        // This lock is only against the exchange of the port by the other thread; the loop never
        // takes it.
        const std::lock_guard lock(mutex_);
        // Nor is one that was made for what the device said before it was lost.
        is_given = is_given && command.opening == reopened();
        if (!is_given) command = {};
        if (port_ != nullptr && !broken_.load()) send(command, is_given);
      }
      if (last) return;
      given_.wait(seen, std::memory_order_acquire);
      seen = given_.load(std::memory_order_acquire);
    }
  }

  void send(const Stamped<Command>& command, bool is_given) {
    if (!port_->send(command.value)) {
      broken_.store(true);
      open_now_.store(false, std::memory_order_release);
      send_zero();
    } else if (is_given) {
      const std::int64_t now = now_ns();
      command_sent_.add(now - command.at_ns);
      // Only this thread writes them; a mean may be off by one command.
      sent_ns_.store(sent_ns_.load(std::memory_order_relaxed) +
                         static_cast<std::uint64_t>(std::max<std::int64_t>(0, now - command.at_ns)),
                     std::memory_order_relaxed);
      sent_.store(sent_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
      if (command.answered_ns != 0) report_to_command_.add(now - command.answered_ns);
    }
  }

  Open open_;
  /// Set and reset under the mutex, by the receiving thread or by the thread that searches for the
  /// device.
  std::unique_ptr<DevicePort> port_;
  std::mutex mutex_;
  mutable std::mutex error_mutex_;
  std::string last_error_;
  std::mutex tell_mutex_;
  std::function<void()> tell_;
  std::thread receiver_, sender_, guard_;
  bool raised_ = false;  ///< used by the guard
  // Used by the receiving thread, and by the one that searches, which it waits for:
  std::chrono::microseconds retry_{0};  ///< until the next search for a lost device
  std::int64_t opened_ns_ = 0;          ///< when the device was found again; 0: it was not
  LatestValue<Stamped<Report>> reports_;
  LatestValue<Stamped<Command>> commands_;
  ReportSignal came_;
  LatencyHistogram report_age_;         ///< counted by the loop
  LatencyHistogram command_sent_;       ///< counted by the sending thread
  LatencyHistogram report_to_command_;  ///< counted by the sending thread
  std::int64_t answered_ns_ = 0;  ///< used by the loop: when the report came that it took; 0: none
  std::int64_t newest_came_ns_ = 0;  ///< used by the loop: of the report that it has; 0: none
  DelayCounts read_;                 ///< used by the loop: of readings alone
  std::atomic<std::uint64_t> sent_{0}, sent_ns_{0};  ///< of commands
  /// used by the loop: the opening for which it last looked for a report
  std::uint32_t taken_opening_ = 0;
  std::uint32_t looked_opening_ = 0;        ///< used by the loop: `reopened` when it last looked
  std::atomic<std::int64_t> looked_ns_{0};  ///< when that was; 0: not yet
  std::atomic<std::uint32_t> given_{0};     ///< changes with each command
  std::atomic<std::uint32_t> reopened_{0};
  std::atomic<std::int64_t> given_ns_{0};  ///< when the last one was given; 0: none yet
  std::atomic<bool> open_now_{false}, broken_{false}, stop_{false};
  /// when the loop gave its last command, if it stalls and the sending thread has not come to that
  /// yet; otherwise 0
  std::atomic<std::int64_t> stalled_since_ns_{0};
};

}  // namespace spm::servo
