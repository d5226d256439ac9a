// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pthread.h>

#include <string>
#include <vector>

#include "common/base/error.hpp"

namespace spm::servo {

enum class RealtimeMode { require, attempt, off };

/// What the loop's thread was granted.
struct RealtimeState {
  /// "fifo" by the process's own limits, "rtkit" from RealtimeKit (round robin), or "other".
  std::string policy = "other";
  int priority = 0;
  bool memory_locked = false;
  std::vector<std::string> warnings;  ///< what was refused, with its cure; one sentence each
};

/// Makes the calling thread a real-time thread, locks the process's memory and touches the thread's
/// stack. The policy is SCHED_FIFO, or the one of RealtimeKit if the process's limits refuse that.
/// What is refused becomes a warning, or with `require` an error of realtime_refused. May block for
/// seconds.
[[nodiscard]] Result<RealtimeState> enter_realtime(RealtimeMode mode);

/// Gives the calling thread, which talks to a device, a real-time priority below the loop's, if
/// that is allowed. If not, the loop's warnings say so.
void enter_device_thread(RealtimeMode mode) noexcept;

/// Gives the calling thread a real-time priority above the loop's, if that is allowed. For what
/// ends a force where the loop no longer sleeps: it must do little.
void enter_guard_thread(RealtimeMode mode) noexcept;

/// Raises a thread above the loop, if it has a real-time priority by the process's own limits.
/// False if it has none, or that is refused.
bool raise_above_loop(pthread_t thread) noexcept;

/// Puts a thread that was raised back below the loop.
void lower_below_loop(pthread_t thread) noexcept;

/// Makes the calling thread an ordinary one. For new threads, which inherit the priority of the
/// thread that made them.
void leave_realtime() noexcept;

}  // namespace spm::servo
