// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "servo/devices/base/delay_counts.hpp"

namespace spm::servo {

/// Measures the mean time from a device's reading to the force that answers it, and says with which
/// delay to count. A longer one counts at once, a shorter one only when it has stayed for a while,
/// so that stiffness does not wander under a hand. No call allocates or throws.
class DelayWatch {
 public:
  /// Readings over which a mean is taken, and how many means in turn must be shorter.
  static constexpr std::uint64_t window = 256;
  static constexpr int settled_windows = 8;
  /// Ticks: delays are counted in these, rounded up.
  static constexpr double step = 0.25;

  /// `tick` in s; `own_delay`: what the device adds that is not in its counts, s.
  DelayWatch(double tick, double own_delay) noexcept;

  /// Call it in each tick. True if the delay that counts is another than before.
  bool look(const DelayCounts& counts) noexcept;

  /// Ticks; at least the one for which stiffness was measured, at most what the settings allow.
  [[nodiscard]] double counted() const noexcept { return counted_; }
  /// The last mean, ticks; before the first one what the device adds by itself.
  [[nodiscard]] double measured() const noexcept { return measured_; }

 private:
  [[nodiscard]] static double rounded(double ticks) noexcept;

  double tick_, own_ticks_;
  double measured_, counted_;
  DelayCounts before_;
  int shorter_ = 0;  ///< windows in turn whose mean was shorter
};

}  // namespace spm::servo
