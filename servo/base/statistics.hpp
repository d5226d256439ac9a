// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace spm::servo {

/// Summary of a set of numbers. Percentiles by the nearest-rank rule; all zero for an empty set.
struct Summary {
  double mean = 0;
  double sd = 0;  ///< of the population
  double p50 = 0;
  double p99 = 0;
  double p999 = 0;
  double max = 0;
};

/// Exact summary of the values. Reorders them.
[[nodiscard]] Summary summarise(std::vector<double>& values);

/// Durations of a run of any length in a fixed amount of memory. The buckets have equal relative
/// width, so that a percentile is at most 1/256 above the true one. Mean, deviation and maximum are
/// exact.
class DurationHistogram {
 public:
  DurationHistogram();

  /// Counts a duration, ns; a negative one counts as zero.
  void add(std::int64_t duration_ns);

  /// In microseconds.
  [[nodiscard]] Summary summary_us() const;

 private:
  [[nodiscard]] double percentile_ns(double share) const;

  std::vector<std::uint64_t> buckets_;
  std::uint64_t count_ = 0;
  std::uint64_t max_ = 0;
  double mean_ = 0;
  double squares_ = 0;  ///< sum of squared deviations from the mean
};

}  // namespace spm::servo
