// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "servo/doctor/verdict.hpp"
#include "servo/realtime/realtime.hpp"

namespace spm::servo {

/// What this process is allowed. An empty value means without limit.
struct ProcessLimits {
  bool root = false;                              ///< with all of root's capabilities, or nearly
  std::optional<std::uint64_t> priority = 0;      ///< RLIMIT_RTPRIO
  std::optional<std::uint64_t> memory_bytes = 0;  ///< RLIMIT_MEMLOCK
  bool sys_nice = false;                          ///< CAP_SYS_NICE: the first limit does not hold
  bool ipc_lock = false;                          ///< CAP_IPC_LOCK: nor the second
};

/// Reads the limits from the kernel. A limit that cannot be read counts as 0.
[[nodiscard]] ProcessLimits read_process_limits() noexcept;

/// Good if the loop got SCHED_FIFO.
[[nodiscard]] Check judge_scheduling(const RealtimeState& state, const ProcessLimits& limits);

/// Good if memory is locked, including memory that is mapped later; fair if the latter is not
/// locked.
[[nodiscard]] Check judge_memory_lock(const RealtimeState& state, const ProcessLimits& limits);

}  // namespace spm::servo
