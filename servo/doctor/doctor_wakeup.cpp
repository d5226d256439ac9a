// SPDX-License-Identifier: Apache-2.0
#include "servo/doctor/doctor_wakeup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "servo/base/clock.hpp"
#include "servo/base/schedule.hpp"
#include "servo/realtime/wakeup_latency.hpp"

namespace spm::servo {

namespace {

/// Time from the set-up of the thread to its first tick, as in the loop.
constexpr std::int64_t lead_ns = 2'000'000;
constexpr std::int64_t between_tellings_ns = 100'000'000;

void measure(double seconds, Wakeups& wakeups, std::atomic<std::uint64_t>& tick) {
  DurationHistogram lateness;
  if (auto state = enter_realtime(RealtimeMode::attempt)) wakeups.realtime = std::move(*state);
  const WakeupLatency latency = WakeupLatency::hold(RealtimeMode::attempt);
  const auto ticks = static_cast<std::uint64_t>(std::llround(seconds * doctor_rate_hz));
  TickSchedule schedule(now_ns() + lead_ns, doctor_rate_hz);
  while (schedule.index() < ticks) {
    sleep_until(schedule.due());
    const std::int64_t now = now_ns();
    const std::int64_t late = now - schedule.due();
    wakeups.count(late);
    lateness.add(late);
    wakeups.skipped += schedule.advance(now);
    tick.store(schedule.index(), std::memory_order_relaxed);
  }
  wakeups.us = lateness.summary_us();
}

}  // namespace

void Wakeups::count(std::int64_t late_ns) noexcept {
  ++ticks;
  if (late_ns >= 200'000) ++late_200us;
  if (late_ns >= 500'000) ++late_500us;
  if (late_ns >= missed_ns) ++late_1ms;
}

Wakeups measure_wakeups(double seconds, const std::function<void(double)>& progress) {
  Wakeups wakeups;
  wakeups.seconds = seconds;
  std::atomic<std::uint64_t> tick{0};
  std::atomic<bool> done{false};
  // In a thread of its own, so that the rest of the program keeps its ordinary priority.
  std::thread thread([&] {
    measure(seconds, wakeups, tick);
    done.store(true, std::memory_order_release);
  });
  while (!done.load(std::memory_order_acquire)) {
    sleep_until(now_ns() + between_tellings_ns);
    const auto share =
        static_cast<double>(tick.load(std::memory_order_relaxed)) / (seconds * doctor_rate_hz);
    if (progress) progress(std::min(share, 1.0));
  }
  thread.join();
  return wakeups;
}

Check judge_wakeups(const Wakeups& wakeups) {
  Check check{"wake_up", Verdict::unknown, "", ""};
  if (wakeups.ticks == 0) {
    check.measured = "no wake-up was measured";
    check.cure = "Measure for longer, with --seconds.";
    return check;
  }
  check.measured = fmt::format(
      "{} wake-ups at {:.0f} Hz, late by p50 {:.0f}, p99 {:.0f}, p99.9 {:.0f}, max {:.0f} us; {} "
      "by "
      "200 us or more, {} by 500 us, {} by 1 ms",
      wakeups.ticks, doctor_rate_hz, wakeups.us.p50, wakeups.us.p99, wakeups.us.p999,
      wakeups.us.max, wakeups.late_200us, wakeups.late_500us, wakeups.late_1ms);
  if (wakeups.us.p999 < good_wakeup_us && wakeups.late_1ms == 0) {
    check.verdict = Verdict::good;
    return check;
  }
  check.verdict = wakeups.us.p999 < fair_wakeup_us ? Verdict::fair : Verdict::poor;
  check.cure =
      "Follow the cures below from the top, stop programs that keep the cores busy, and measure "
      "again.";
  return check;
}

}  // namespace spm::servo
