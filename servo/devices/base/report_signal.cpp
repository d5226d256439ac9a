// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/base/report_signal.hpp"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>

namespace spm::servo {

static_assert(sizeof(std::atomic<std::uint32_t>) == sizeof(std::uint32_t) &&
                  std::atomic<std::uint32_t>::is_always_lock_free,
              "the kernel reads the counter as a plain word");

// Either the signalling thread sees that somebody waits, or the waiting thread sees the new count:
// all four accesses below are sequentially consistent.

void ReportSignal::raise() noexcept {
  count_.fetch_add(1, std::memory_order_seq_cst);
  if (!is_waited_for_.load(std::memory_order_seq_cst)) return;
  static_cast<void>(::syscall(SYS_futex, &count_, FUTEX_WAKE_PRIVATE, 1, nullptr, nullptr, 0));
}

bool ReportSignal::wait(std::uint32_t seen, std::int64_t until_ns) noexcept {
  // The only futex wait with an absolute time; by default that of CLOCK_MONOTONIC.
  constexpr int operation = FUTEX_WAIT_BITSET_PRIVATE;
  timespec until{};
  until.tv_sec = until_ns / 1'000'000'000;
  until.tv_nsec = until_ns % 1'000'000'000;
  is_waited_for_.store(true, std::memory_order_seq_cst);
  while (count_.load(std::memory_order_seq_cst) == seen) {
    const long woken =
        ::syscall(SYS_futex, &count_, operation, seen, &until, nullptr, FUTEX_BITSET_MATCH_ANY);
    if (woken != 0 && errno != EAGAIN && errno != EINTR) break;
  }
  is_waited_for_.store(false, std::memory_order_relaxed);
  return count() != seen;
}

}  // namespace spm::servo
