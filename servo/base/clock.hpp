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

/// How long the machine has slept since it was started, nanoseconds: CLOCK_BOOTTIME goes on then.
/// A reading that was interrupted is made again.
[[nodiscard]] inline std::int64_t asleep_ns() noexcept {
  constexpr std::int64_t at_once_ns = 1'000'000;
  std::int64_t asleep = 0;
  for (int attempt = 0; attempt < 8; ++attempt) {
    const std::int64_t before = now_ns();
    timespec time{};
    clock_gettime(CLOCK_BOOTTIME, &time);
    asleep = std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec - now_ns();
    if (now_ns() - before < at_once_ns) break;
  }
  return asleep;
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
