// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

namespace spm::servo {

/// The loop's time grid: tick k is due at start + k periods, nanoseconds of CLOCK_MONOTONIC. Ticks
/// whose time has passed are skipped, so that late ticks are never bunched.
class TickSchedule {
 public:
  TickSchedule(std::int64_t start_ns, double rate_hz) noexcept
      : start_ns_(start_ns), period_ns_(1e9 / rate_hz) {}

  [[nodiscard]] std::uint64_t index() const noexcept { return index_; }
  [[nodiscard]] std::int64_t due() const noexcept { return due_at(index_); }
  [[nodiscard]] double period_ns() const noexcept { return period_ns_; }

  /// Goes to the first tick of the grid that is due after `now_ns`, and at least one tick further.
  /// Returns how many ticks were skipped.
  std::uint64_t advance(std::int64_t now_ns) noexcept {
    std::uint64_t next = index_ + 1;
    if (due_at(next) <= now_ns) {
      next = static_cast<std::uint64_t>(static_cast<double>(now_ns - start_ns_) / period_ns_);
      while (due_at(next) <= now_ns) ++next;
    }
    const std::uint64_t skipped = next - index_ - 1;
    index_ = next;
    return skipped;
  }

  /// Moves the grid so that this tick is due at `now_ns`. For loops whose pace is set by a device's
  /// reports.
  void shift_to(std::int64_t now_ns) noexcept { start_ns_ += now_ns - due(); }

 private:
  [[nodiscard]] std::int64_t due_at(std::uint64_t index) const noexcept {
    return start_ns_ + std::llround(static_cast<double>(index) * period_ns_);
  }

  std::int64_t start_ns_;
  double period_ns_;
  std::uint64_t index_ = 0;
};

}  // namespace spm::servo
