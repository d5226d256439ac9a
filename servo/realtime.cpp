// SPDX-License-Identifier: Apache-2.0
#include "servo/realtime.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstddef>
#include <cstring>

namespace spm::servo {

namespace {

/// Above every ordinary process and the threaded interrupts' default of 50, below watchdogs.
constexpr int loop_priority = 80;
constexpr int device_priority = 85;

constexpr std::size_t stack_bytes = std::size_t{256} * 1024;

[[gnu::noinline]] void touch_stack() noexcept {
  char stack[stack_bytes];
  volatile char* page = stack;
  for (std::size_t i = 0; i < stack_bytes; i += 1024) page[i] = 0;
}

/// Later memory is locked too only where no limit can make an allocation fail for it.
bool lock_memory() noexcept {
  rlimit limit{};
  const bool unlimited =
      geteuid() == 0 || (getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY);
  return mlockall(unlimited ? MCL_CURRENT | MCL_FUTURE : MCL_CURRENT) == 0;
}

}  // namespace

Result<RealtimeState> enter_realtime(RealtimeMode mode) {
  RealtimeState state;
  touch_stack();
  if (mode == RealtimeMode::off) return state;

  // Where SCHED_FIFO is refused, at least no slack of 50 us is added to each sleep.
  prctl(PR_SET_TIMERSLACK, 1UL);

  sched_param parameters{};
  parameters.sched_priority = loop_priority;
  const int refused = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  if (refused == 0) {
    state.policy = "fifo";
    state.priority = loop_priority;
  } else {
    state.warnings.push_back(std::string("the loop has no real-time priority (") +
                             std::strerror(refused) +
                             "): run as root, or allow it with 'rtprio 90' in "
                             "/etc/security/limits.d and log in again");
  }

  state.memory_locked = lock_memory();
  if (!state.memory_locked) {
    state.warnings.push_back(
        "the memory could not be locked (its limit is too low): run as root, or allow it with "
        "'memlock unlimited' in /etc/security/limits.d and log in again");
  }

  if (mode == RealtimeMode::require && !state.warnings.empty()) {
    return fail(ExitCode::realtime_refused,
                "real time was required, but " + state.warnings.front());
  }
  return state;
}

void enter_device_thread(RealtimeMode mode) noexcept {
  if (mode == RealtimeMode::off) return;
  prctl(PR_SET_TIMERSLACK, 1UL);
  sched_param parameters{};
  parameters.sched_priority = device_priority;
  static_cast<void>(pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters));
}

}  // namespace spm::servo
