// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/base/error.hpp"

namespace spm::servo {

enum class RealtimeMode { require, attempt, off };

/// What the loop's thread was given.
struct RealtimeState {
  /// "fifo" by the process's own limits, "rtkit" by RealtimeKit (round robin), or "other".
  std::string policy = "other";
  int priority = 0;
  bool memory_locked = false;
  std::vector<std::string> warnings;  ///< what was refused, with its cure; a sentence each
};

/// Makes the calling thread a real-time one (SCHED_FIFO, or where the process's limits refuse that,
/// by RealtimeKit), locks the process's memory and touches the thread's stack. What is refused
/// becomes a warning; with `require` an error of realtime_refused. May block for seconds.
[[nodiscard]] Result<RealtimeState> enter_realtime(RealtimeMode mode);

/// Makes the calling thread, which talks to a device, a real-time one below the loop where that is
/// allowed. The loop's warnings tell what is not.
void enter_device_thread(RealtimeMode mode) noexcept;

/// Makes the calling thread an ordinary one; one begins with the priority of the thread that made
/// it.
void leave_realtime() noexcept;

}  // namespace spm::servo
