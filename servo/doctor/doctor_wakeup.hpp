// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include "servo/base/statistics.hpp"
#include "servo/doctor/verdict.hpp"
#include "servo/realtime/realtime.hpp"

namespace spm::servo {

/// Rate at which `doctor` measures, Hz.
inline constexpr double doctor_rate_hz = 1000;

/// Largest lateness of 99.9 % of the wake-ups, us: a quarter and half of a tick at 1 kHz. On a
/// virtual machine with two shared cores that held 1 kHz, cyclictest counted 172 us, and 322 us
/// beside a load on every core, with SCHED_FIFO; 7842 us without it.
inline constexpr double good_wakeup_us = 250;
inline constexpr double fair_wakeup_us = 500;

/// A tick at 1 kHz, ns. A wake-up that is this late has missed a tick.
inline constexpr std::int64_t missed_ns = 1'000'000;

/// How late a thread woke up that wanted to run at a rate.
struct Wakeups {
  std::uint64_t ticks = 0;
  std::uint64_t skipped = 0;     ///< ticks of the grid that were skipped because of late wake-ups
  std::uint64_t late_200us = 0;  ///< wake-ups that were late by 200 us or more
  std::uint64_t late_500us = 0;
  std::uint64_t late_1ms = 0;
  Summary us;
  double seconds = 0;
  RealtimeState realtime;  ///< what the thread was granted

  /// Counts one wake-up; the summary is made at the end.
  void count(std::int64_t late_ns) noexcept;
};

/// Wakes a thread up at doctor_rate_hz for `seconds`, with the loop's own set-up and clock.
/// `progress` is called with the finished fraction, 0 to 1, on the calling thread.
[[nodiscard]] Wakeups measure_wakeups(double seconds, const std::function<void(double)>& progress);

/// Good: 99.9 % within good_wakeup_us and none late by a tick. Fair: 99.9 % within fair_wakeup_us.
[[nodiscard]] Check judge_wakeups(const Wakeups& wakeups);

}  // namespace spm::servo
