// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <thread>

namespace spm::servo {

/// Learns from logind that the machine is going to sleep, in a thread of its own, and delays that
/// until the loop has had time to send zero force: a device that keeps its power would hold the
/// last one. Where there is no system bus or no logind it does nothing; Loop then sees the sleep
/// when it is over.
class SleepNotice {
 public:
  SleepNotice();
  SleepNotice(const SleepNotice&) = delete;
  SleepNotice& operator=(const SleepNotice&) = delete;
  ~SleepNotice();

  /// True from when the machine prepares for sleep until it is awake.
  [[nodiscard]] const std::atomic<bool>& sleeping() const noexcept { return sleeping_; }

 private:
  void watch() noexcept;

  std::atomic<bool> sleeping_{false}, stop_{false};
  std::thread thread_;
};

}  // namespace spm::servo
