// SPDX-License-Identifier: Apache-2.0
#include "servo/realtime/realtime.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>

#include "servo/realtime/capabilities.hpp"
#include "servo/realtime/realtime_kit.hpp"

namespace spm::servo {

namespace {

/// Above every ordinary process and the default of 50 of threaded interrupts, below the watchdogs.
constexpr int loop_priority = 80;
/// Below the loop. Otherwise the thread that the loop wakes to send would take the processor from
/// the loop in the middle of a tick. The loop sleeps most of the time, and these threads do little.
constexpr int device_priority = 75;

/// Above the loop, so that a loop that no longer sleeps cannot keep it from its core.
constexpr int guard_priority = 85;

/// How far below the highest priority that RealtimeKit grants: in the same order as above.
constexpr int guard_below_most = 0;
constexpr int loop_below_most = 1;
constexpr int device_below_most = 2;

constexpr std::size_t stack_bytes = std::size_t{256} * 1024;

[[gnu::noinline]] void touch_stack() noexcept {
  char stack[stack_bytes];
  volatile char* page = stack;
  for (std::size_t i = 0; i < stack_bytes; i += 1024) page[i] = 0;
}

/// Memory that is mapped later is locked too, but only if no limit can make an allocation fail
/// because of it.
bool lock_memory() noexcept {
  rlimit limit{};
  const bool unlimited = has_capability(CAP_IPC_LOCK) || (getrlimit(RLIMIT_MEMLOCK, &limit) == 0 &&
                                                          limit.rlim_cur == RLIM_INFINITY);
  return mlockall(unlimited ? MCL_CURRENT | MCL_FUTURE : MCL_CURRENT) == 0;
}

struct GivenPriority {
  const char* policy;
  int priority;
};

/// Takes a priority by the process's own limits, or else from RealtimeKit. Errors:
/// realtime_refused, with both reasons.
Result<GivenPriority> take_priority(int priority, int below_most) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  const int refused = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  if (refused == 0) return GivenPriority{"fifo", priority};
  std::string why = std::strerror(refused);
  if (refused == EPERM) {
    const Result<int> given = ask_realtime_kit(below_most);
    if (given) return GivenPriority{"rtkit", *given};
    why += "; " + given.error().message;
  }
  return fail(ExitCode::realtime_refused, why);
}

}  // namespace

Result<RealtimeState> enter_realtime(RealtimeMode mode) {
  RealtimeState state;
  touch_stack();
  if (mode == RealtimeMode::off) return state;

  // If no priority is granted, at least sleeps are not prolonged by the default slack of 50 us.
  prctl(PR_SET_TIMERSLACK, 1UL);

  const Result<GivenPriority> given = take_priority(loop_priority, loop_below_most);
  if (given) {
    state.policy = given->policy;
    state.priority = given->priority;
  } else {
    state.warnings.push_back("the loop has no real-time priority (" + given.error().message +
                             "): allow it with 'rtprio 90' in /etc/security/limits.d and log in "
                             "again, or give a service CAP_SYS_NICE; root is not needed");
  }

  state.memory_locked = lock_memory();
  // Otherwise the kernel merges small pages into large ones behind the loop's back, and access to
  // them faults.
  prctl(PR_SET_THP_DISABLE, 1UL, 0UL, 0UL, 0UL);
  if (!state.memory_locked) {
    state.warnings.push_back(
        "the memory could not be locked (its limit is too low): allow it with 'memlock unlimited' "
        "in /etc/security/limits.d and log in again, or give a service CAP_IPC_LOCK; root is not "
        "needed");
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
  static_cast<void>(take_priority(device_priority, device_below_most));
}

void enter_guard_thread(RealtimeMode mode) noexcept {
  if (mode == RealtimeMode::off) return;
  prctl(PR_SET_TIMERSLACK, 1UL);
  static_cast<void>(take_priority(guard_priority, guard_below_most));
}

bool raise_above_loop(pthread_t thread) noexcept {
  int policy = SCHED_OTHER;
  sched_param parameters{};
  if (pthread_getschedparam(thread, &policy, &parameters) != 0 || policy != SCHED_FIFO) {
    return false;
  }
  parameters.sched_priority = guard_priority;
  return pthread_setschedparam(thread, SCHED_FIFO, &parameters) == 0;
}

void lower_below_loop(pthread_t thread) noexcept {
  sched_param parameters{};
  parameters.sched_priority = device_priority;
  static_cast<void>(pthread_setschedparam(thread, SCHED_FIFO, &parameters));
}

void leave_realtime() noexcept {
  const sched_param parameters{};
  // Nobody is refused a lower priority than he has.
  static_cast<void>(pthread_setschedparam(pthread_self(), SCHED_OTHER, &parameters));
}

}  // namespace spm::servo
