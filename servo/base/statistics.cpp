// SPDX-License-Identifier: Apache-2.0
#include "servo/base/statistics.hpp"

#include <algorithm>
#include <cmath>

#include "servo/base/duration_buckets.hpp"

namespace spm::servo {

namespace {

constexpr double us_per_ns = 1e-3;

using Buckets = DurationBuckets<8>;

}  // namespace

Summary summarise(std::vector<double>& values) {
  Summary summary;
  if (values.empty()) return summary;
  std::sort(values.begin(), values.end());
  const auto count = static_cast<double>(values.size());
  for (const double value : values) summary.mean += value / count;
  double squares = 0;
  for (const double value : values) squares += (value - summary.mean) * (value - summary.mean);
  summary.sd = std::sqrt(squares / count);
  const auto ranked = [&](double share) { return values[nearest_rank(share, values.size()) - 1]; };
  summary.p50 = ranked(0.5);
  summary.p99 = ranked(0.99);
  summary.p999 = ranked(0.999);
  summary.max = values.back();
  return summary;
}

DurationHistogram::DurationHistogram() : buckets_(Buckets::count, 0) {}

void DurationHistogram::add(std::int64_t duration_ns) {
  const auto value = static_cast<std::uint64_t>(std::max<std::int64_t>(duration_ns, 0));
  ++buckets_[Buckets::of(value)];
  ++count_;
  max_ = std::max(max_, value);
  const double difference = static_cast<double>(value) - mean_;
  mean_ += difference / static_cast<double>(count_);
  squares_ += difference * (static_cast<double>(value) - mean_);
}

double DurationHistogram::percentile_ns(double share) const {
  const std::uint64_t edge = Buckets::ranked(buckets_, nearest_rank(share, count_));
  return static_cast<double>(std::min(edge, max_));
}

Summary DurationHistogram::summary_us() const {
  Summary summary;
  if (count_ == 0) return summary;
  summary.mean = mean_ * us_per_ns;
  summary.sd = std::sqrt(squares_ / static_cast<double>(count_)) * us_per_ns;
  summary.p50 = percentile_ns(0.5) * us_per_ns;
  summary.p99 = percentile_ns(0.99) * us_per_ns;
  summary.p999 = percentile_ns(0.999) * us_per_ns;
  summary.max = static_cast<double>(max_) * us_per_ns;
  return summary;
}

}  // namespace spm::servo
