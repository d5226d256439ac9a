// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cerrno>
#include <cstdint>
#include <ctime>

namespace spm::servo {

/// Time of CLOCK_MONOTONIC, nanoseconds.
[[nodiscard]] inline std::int64_t now_ns() noexcept {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

/// Sleeps until a time of CLOCK_MONOTONIC, nanoseconds; a signal does not end the sleep.
inline void sleep_until(std::int64_t due_ns) noexcept {
  timespec due{};
  due.tv_sec = due_ns / 1'000'000'000;
  due.tv_nsec = due_ns % 1'000'000'000;
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr) == EINTR) {
  }
}

}  // namespace spm::servo
