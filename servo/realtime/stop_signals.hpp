// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace spm::servo {

/// Turns SIGINT, SIGTERM and SIGHUP (unless it is ignored, as under nohup) into a flag that the
/// loop reads, while it lives. The signals are delivered to the thread that made it only: threads
/// started later have them blocked. One at a time.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  [[nodiscard]] const std::atomic<bool>& flag() const noexcept;

  /// Lets the signals in on the calling thread, once all others were started.
  void listen();
};

}  // namespace spm::servo
