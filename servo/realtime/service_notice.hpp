// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>

namespace spm::servo {

/// Tells a service manager (systemd) how this program is. Does nothing if none started it. Every
/// call may block for a short time; not for a tick.
class ServiceNotice {
 public:
  /// `beat`: when the loop's last tick began, now_ns(); it outlives this. From now on the manager's
  /// watchdog, if it has one, is told that all is well, at half its period, whenever the loop has
  /// ticked since it was last told: by a thread that does nothing else, so that neither a slow disk
  /// nor a standard error that nobody reads ends a loop that ticks.
  explicit ServiceNotice(const std::atomic<std::int64_t>& beat);
  ServiceNotice(const ServiceNotice&) = delete;
  ServiceNotice& operator=(const ServiceNotice&) = delete;
  ~ServiceNotice();

  /// The program serves now.
  void ready();
  /// The program ends. Its watchdog hears no more: it has another time limit now.
  void stopping();

 private:
  void feed(std::int64_t period_ns);
  void end();

  const std::atomic<std::int64_t>& beat_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool ends_ = false;
  std::thread thread_;
};

}  // namespace spm::servo
