// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "common/error.hpp"
#include "servo/clock.hpp"
#include "servo/devices/latest_value.hpp"
#include "servo/devices/port.hpp"
#include "servo/realtime.hpp"

namespace spm::servo {

/// Between the blocking calls of a device's connection and the loop, which must not wait: one
/// thread receives reports, opens the device again when it was lost, and another sends commands.
/// The loop takes the newest report and leaves the newest command; both are a few copies and at
/// most one wake-up of a thread. Where the loop stalls, so that it leaves none for too long, the
/// device is sent `Command{}`, which must be no force.
template <class Report, class Command>
class PortThreads {
 public:
  using DevicePort = Port<Report, Command>;
  /// Opens the device, makes it ready (which may take seconds), or says in a sentence why not.
  /// Called by `start`, and by the receiving thread after a loss. It gives up soon once `stop` is
  /// true.
  using Open = std::function<Result<std::unique_ptr<DevicePort>>(const std::atomic<bool>& stop)>;

  /// How long after a loss, or a failed attempt, the device is looked for again.
  static constexpr std::chrono::milliseconds retry_interval{200};

  /// After so long without a command from the loop the device is sent none: twenty ticks of the
  /// usual rate, more than a loop misses that still runs.
  static constexpr std::int64_t stall_ns = 20'000'000;

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
    return {};
  }

  /// Ends the threads; a command that was left before is sent still.
  void end() noexcept {
    if (!receiver_.joinable()) return;
    stop_.store(true);
    wake_sender();
    sender_.join();
    receiver_.join();
    port_.reset();
    open_now_.store(false);
  }

  /// By the loop: the newest report, and when it came (now_ns()), where one has come since.
  [[nodiscard]] bool take(Report& report, std::int64_t& came_ns) noexcept {
    Stamped newest;
    if (!reports_.take(newest)) return false;
    report = newest.report;
    came_ns = newest.came_ns;
    return true;
  }

  /// By the loop: leaves a command for the sending thread. Of several that it did not come to, the
  /// last is sent.
  void give(const Command& command) noexcept {
    commands_.put(command);
    given_ns_.store(now_ns(), std::memory_order_relaxed);
    wake_sender();
  }

  /// Whether the device is there.
  [[nodiscard]] bool is_open() const noexcept { return open_now_.load(std::memory_order_acquire); }
  /// Counts how often the device was opened again.
  [[nodiscard]] std::uint32_t reopened() const noexcept {
    return reopened_.load(std::memory_order_relaxed);
  }

 private:
  struct Stamped {
    Report report{};
    std::int64_t came_ns = 0;
  };

  void wake_sender() noexcept {
    given_.fetch_add(1, std::memory_order_release);
    given_.notify_one();
  }

  void receive_all() {
    while (!stop_.load()) {
      if (broken_.exchange(false)) lose();
      if (port_ == nullptr) {
        open_again();
        continue;
      }
      look_after_loop();
      Stamped stamped;
      switch (port_->receive(stamped.report)) {
        case Received::report:
          stamped.came_ns = now_ns();
          reports_.put(stamped);
          break;
        case Received::nothing:
          break;
        case Received::gone:
          lose();
          break;
      }
    }
  }

  void look_after_loop() {
    const std::int64_t given = given_ns_.load(std::memory_order_relaxed);
    if (given == 0 || now_ns() - given <= stall_ns) return;
    stalled_.store(true, std::memory_order_relaxed);
    wake_sender();
  }

  void lose() {
    open_now_.store(false, std::memory_order_release);
    const std::lock_guard lock(mutex_);
    port_.reset();
  }

  void open_again() {
    for (auto waited = std::chrono::milliseconds(0); waited < retry_interval && !stop_.load();
         waited += port_wait) {
      std::this_thread::sleep_for(port_wait);
    }
    if (stop_.load()) return;
    auto port = open_(stop_);
    if (!port) return;
    const std::lock_guard lock(mutex_);
    port_ = std::move(*port);
    broken_.store(false);
    reopened_.fetch_add(1, std::memory_order_relaxed);
    open_now_.store(true, std::memory_order_release);
  }

  void send_all() {
    std::uint32_t seen = 0;
    while (true) {
      const bool last = stop_.load();
      Command command{};
      const bool is_given = commands_.take(command);
      const bool is_stalled = stalled_.exchange(false, std::memory_order_relaxed);
      if (is_given || is_stalled) {
        // Only against the other thread's exchange of the port; the loop never takes it.
        const std::lock_guard lock(mutex_);
        if (port_ != nullptr && !broken_.load() && !port_->send(command)) {
          broken_.store(true);
          open_now_.store(false, std::memory_order_release);
        }
      }
      if (last) return;
      given_.wait(seen, std::memory_order_acquire);
      seen = given_.load(std::memory_order_acquire);
    }
  }

  Open open_;
  std::unique_ptr<DevicePort> port_;  ///< set and reset by the receiving thread, under the mutex
  std::mutex mutex_;
  std::thread receiver_, sender_;
  LatestValue<Stamped> reports_;
  LatestValue<Command> commands_;
  std::atomic<std::uint32_t> given_{0};  ///< changes with each command
  std::atomic<std::uint32_t> reopened_{0};
  std::atomic<std::int64_t> given_ns_{0};  ///< when the last was; 0: none yet
  std::atomic<bool> open_now_{false}, broken_{false}, stop_{false};
  std::atomic<bool> stalled_{false};  ///< the loop is; the sending thread has not sent zero yet
};

}  // namespace spm::servo
