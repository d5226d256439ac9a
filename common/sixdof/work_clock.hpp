// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace spm {

/// Limits on the work of a tick.
struct TickBudget {
  std::int64_t nanoseconds = 0;  ///< 0: no limit
  /// reading of a monotonic clock, ns; null: that of std::chrono::steady_clock.
  std::int64_t (*now)() noexcept = nullptr;
  std::uint32_t finest_level =
      std::numeric_limits<std::uint32_t>::max();  ///< finer levels are not used
  /// Samples below the coarsest level after which time is over: a tick that was ended by a clock is
  /// repeated without one by the work that it had done.
  std::uint32_t work = std::numeric_limits<std::uint32_t>::max();
  /// m: samples that are so near are listed, so that looks within that way are quick; 0: none are.
  double ahead = 0;
  /// m: samples that are so near are told, as NearContact; 0: none are.
  double near = 0;
  /// Finer levels are not looked at once the sums of two differ by less than this part; the finer
  /// is then off by about a quarter of it. 0: all contact is resolved to the finest.
  double accuracy = 0;
  /// Where time runs out, the last level that was finished counts, instead of a part of the next.
  bool whole_levels = false;
  /// Samples above the finest count as points, as those do, and not as patches. Then no level holds
  /// the tool where a finer one would not, and their sum is the gradient of a potential.
  bool as_points = false;
  /// Least time for what is looked at anew, however long the lists of near samples took, ns.
  std::int64_t anew = 0;
  /// Each object is looked at no finer than in the last look without this.
  bool same_levels = false;
};

/// Tells the search for contacts when its time is over.
class WorkClock {
 public:
  /// What pressing a sample is taken to need before any was measured, and at the least; ns.
  static constexpr double least_press_time = 30;

  WorkClock(const TickBudget& budget, double press_time) noexcept
      : now_(budget.now != nullptr ? budget.now : &steady_now),
        limited_(budget.nanoseconds > 0),
        press_time_(press_time),
        work_(budget.work) {
    if (!limited_) return;
    last_ = now_();
    end_ = last_ + budget.nanoseconds;
  }
  /// What was done since the last reading was no piece of the work that `over` judges.
  void go_on() noexcept {
    if (limited_) last_ = now_();
  }
  /// From here on there is at least that time, ns.
  void grant(std::int64_t nanoseconds) noexcept {
    if (limited_) end_ = std::max(end_, now_() + nanoseconds);
  }
  /// True where time is over. Also where it would run out if the next piece of work and the end of
  /// the tick each took as long as the longest so far, with this many samples still to be pressed.
  /// `asked`: queries so far; `worked`: samples so far.
  [[nodiscard]] bool over(std::uint64_t asked, std::uint32_t worked,
                          std::size_t to_press) noexcept {
    if (worked >= work_) return true;
    if (!limited_) return false;
    if (asked - asked_ < asked_a_look && ++passed_ < passed_a_look) return false;
    asked_ = asked;
    passed_ = 0;
    const std::int64_t now = now_();
    longest_ = std::max(longest_, now - last_);
    last_ = now;
    const auto pressing = static_cast<std::int64_t>(press_time_ * static_cast<double>(to_press));
    return now + 2 * longest_ + pressing >= end_;
  }
  /// Measures the time to press one sample, ns, from a batch that `press` presses; only large
  /// enough batches count. What was measured before is forgotten little by little.
  template <class Press>
  [[nodiscard]] double time_of(std::size_t samples, const Press& press) noexcept {
    constexpr std::size_t few = 32;
    if (!limited_ || samples < few) {
      press();
      return std::max(least_press_time, press_time_ * forgotten_share);
    }
    const std::int64_t begun = now_();
    press();
    const double taken = static_cast<double>(now_() - begun) / static_cast<double>(samples);
    // Beyond that something else had the core, or later ticks would see no time for any level.
    return std::clamp(taken, press_time_ * forgotten_share, most_press_time);
  }

 private:
  /// Queries of a field between two readings of the clock, which take about as long as one.
  static constexpr std::uint64_t asked_a_look = 4;
  /// Number of samples that are skipped between two readings of the clock, where none of them
  /// queries a field.
  static constexpr int passed_a_look = 16;
  static constexpr double most_press_time = 1000;  ///< ns
  /// The part of the longest press time that is kept from tick to tick.
  static constexpr double forgotten_share = 0.95;

  static std::int64_t steady_now() noexcept {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }

  std::int64_t (*now_)() noexcept;
  bool limited_;
  double press_time_;  ///< ns per sample
  std::uint32_t work_;
  std::int64_t end_ = 0;
  std::int64_t last_ = 0;
  std::int64_t longest_ = 0;
  std::uint64_t asked_ = 0;
  int passed_ = 0;
};

}  // namespace spm
