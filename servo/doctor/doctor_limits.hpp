// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "servo/doctor/verdict.hpp"
#include "servo/realtime/realtime.hpp"

namespace spm::servo {

/// What this process is allowed. Nothing means without limit.
struct ProcessLimits {
  bool root = false;
  std::optional<std::uint64_t> priority = 0;      ///< RLIMIT_RTPRIO
  std::optional<std::uint64_t> memory_bytes = 0;  ///< RLIMIT_MEMLOCK
};

/// Asks the kernel; a limit that cannot be asked for counts as 0.
[[nodiscard]] ProcessLimits read_process_limits() noexcept;

/// Good where the loop got SCHED_FIFO.
[[nodiscard]] Check judge_scheduling(const RealtimeState& state, const ProcessLimits& limits);

/// Good where memory is locked, and what is mapped later too; fair where the latter is not.
[[nodiscard]] Check judge_memory_lock(const RealtimeState& state, const ProcessLimits& limits);

}  // namespace spm::servo
