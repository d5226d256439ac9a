// SPDX-License-Identifier: Apache-2.0
#include "servo/statistics.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

namespace spm::servo {

namespace {

constexpr double us_per_ns = 1e-3;

/// Values below 2^9 have a bucket each; above, every power of two has 2^8 buckets.
constexpr unsigned fraction_bits = 8;
constexpr std::uint64_t first_wide = std::uint64_t{2} << fraction_bits;
constexpr std::size_t bucket_count = (64 - fraction_bits) << fraction_bits;

std::size_t bucket_of(std::uint64_t value) noexcept {
  if (value < first_wide) return value;
  const unsigned shift = static_cast<unsigned>(std::bit_width(value)) - 1 - fraction_bits;
  return (std::size_t{shift} << fraction_bits) + (value >> shift);
}

/// Largest value that a bucket holds.
std::uint64_t upper_edge(std::size_t bucket) noexcept {
  if (bucket < first_wide) return bucket;
  const std::size_t shift = (bucket >> fraction_bits) - 1;
  const std::uint64_t mantissa = bucket - (shift << fraction_bits);
  return ((mantissa + 1) << shift) - 1;
}

/// Nearest rank, 1 to count.
std::uint64_t rank_of(double share, std::uint64_t count) noexcept {
  const double rank = std::ceil(share * static_cast<double>(count));
  return std::clamp<std::uint64_t>(static_cast<std::uint64_t>(rank), 1, count);
}

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
  const auto ranked = [&](double share) { return values[rank_of(share, values.size()) - 1]; };
  summary.p50 = ranked(0.5);
  summary.p99 = ranked(0.99);
  summary.p999 = ranked(0.999);
  summary.max = values.back();
  return summary;
}

DurationHistogram::DurationHistogram() : buckets_(bucket_count, 0) {}

void DurationHistogram::add(std::int64_t duration_ns) {
  const auto value = static_cast<std::uint64_t>(std::max<std::int64_t>(duration_ns, 0));
  ++buckets_[bucket_of(value)];
  ++count_;
  max_ = std::max(max_, value);
  const double difference = static_cast<double>(value) - mean_;
  mean_ += difference / static_cast<double>(count_);
  squares_ += difference * (static_cast<double>(value) - mean_);
}

double DurationHistogram::percentile_ns(double share) const {
  const std::uint64_t rank = rank_of(share, count_);
  std::uint64_t seen = 0;
  for (std::size_t bucket = 0; bucket < buckets_.size(); ++bucket) {
    seen += buckets_[bucket];
    if (seen >= rank) return static_cast<double>(std::min(upper_edge(bucket), max_));
  }
  return static_cast<double>(max_);
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
