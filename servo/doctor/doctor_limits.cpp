// SPDX-License-Identifier: Apache-2.0
#include "servo/doctor/doctor_limits.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include "servo/realtime/capabilities.hpp"

namespace spm::servo {

namespace {

/// The highest priority that the servo asks for, that of its loop.
constexpr std::uint64_t wanted_priority = 80;

constexpr const char* install_limits =
    "Install 95-spm-haptics.conf in /etc/security/limits.d, join its group with 'sudo usermod -aG "
    "spm-haptics $USER', and log in again; or run a system service with "
    "'AmbientCapabilities=CAP_SYS_NICE CAP_IPC_LOCK'. Root is not needed.";

std::optional<std::uint64_t> soft_limit(__rlimit_resource resource) noexcept {
  rlimit limit{};
  if (getrlimit(resource, &limit) != 0) return 0;
  if (limit.rlim_cur == RLIM_INFINITY) return std::nullopt;
  return limit.rlim_cur;
}

/// `capability`: the one that lifts the limit, if the process has it; empty otherwise.
std::string limit_text(const ProcessLimits& limits, const std::string& capability,
                       const std::string& limited) {
  if (limits.root) return "root, so without limit";
  return capability.empty() ? "limit " + limited : capability + ", so without limit";
}

}  // namespace

ProcessLimits read_process_limits() noexcept {
  return {geteuid() == 0, soft_limit(RLIMIT_RTPRIO), soft_limit(RLIMIT_MEMLOCK),
          has_capability(CAP_SYS_NICE), has_capability(CAP_IPC_LOCK)};
}

Check judge_scheduling(const RealtimeState& state, const ProcessLimits& limits) {
  const std::string allowed =
      limit_text(limits, limits.sys_nice ? "CAP_SYS_NICE" : "",
                 limits.priority ? fmt::format("rtprio {}", *limits.priority) : "rtprio unlimited");
  if (state.policy == "fifo") {
    return {"scheduling", Verdict::good,
            fmt::format("SCHED_FIFO with priority {} ({})", state.priority, allowed), ""};
  }
  if (state.policy == "rtkit") {
    return {"scheduling", Verdict::fair,
            fmt::format("RealtimeKit gave priority {} ({})", state.priority, allowed),
            install_limits};
  }
  const bool promised =
      limits.root || limits.sys_nice || !limits.priority || *limits.priority >= wanted_priority;
  return {"scheduling", Verdict::poor, fmt::format("SCHED_FIFO was refused ({})", allowed),
          promised ? "The limit allows it, so a container or a control group refuses: give it "
                     "CAP_SYS_NICE or a share of the real-time time (cpu.rt_runtime_us)."
                   : install_limits};
}

Check judge_memory_lock(const RealtimeState& state, const ProcessLimits& limits) {
  const std::string allowed =
      limit_text(limits, limits.ipc_lock ? "CAP_IPC_LOCK" : "",
                 limits.memory_bytes ? fmt::format("memlock {} KiB", *limits.memory_bytes / 1024)
                                     : "memlock unlimited");
  if (!state.memory_locked) {
    return {"memory_lock", Verdict::poor, fmt::format("memory cannot be locked ({})", allowed),
            install_limits};
  }
  if (!limits.root && !limits.ipc_lock && limits.memory_bytes) {
    return {"memory_lock", Verdict::fair,
            fmt::format("memory is locked, but not what is mapped later ({})", allowed),
            install_limits};
  }
  return {"memory_lock", Verdict::good, fmt::format("memory is locked ({})", allowed), ""};
}

}  // namespace spm::servo
