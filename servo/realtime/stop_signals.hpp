// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace spm::servo {

/// While it lives, turns SIGINT, SIGTERM and SIGHUP into a flag that the loop reads. SIGHUP is left
/// out if it is ignored, as under nohup. Only the thread that made this object receives the
/// signals: threads started later have them blocked. At most one object at a time.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  [[nodiscard]] const std::atomic<bool>& flag() const noexcept;

  /// Unblocks the signals on the calling thread. Call it when all other threads were started.
  void listen();
};

}  // namespace spm::servo
