// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/base/latency_histogram.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>
#include <vector>

namespace spm::servo {

namespace {

constexpr double us_per_ns = 1e-3;

}  // namespace

void LatencyHistogram::add(std::int64_t duration_ns) noexcept {
  const auto value = static_cast<std::uint64_t>(std::max<std::int64_t>(duration_ns, 0));
  // With only one writer, a count needs no locked instruction.
  if (value > max_.load(std::memory_order_relaxed)) max_.store(value, std::memory_order_relaxed);
  std::atomic<std::uint64_t>& bucket = buckets_[Buckets::of(value)];
  bucket.store(bucket.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

nlohmann::ordered_json LatencyHistogram::json_us() const {
  std::vector<std::uint64_t> counts;
  counts.reserve(buckets_.size());
  for (const auto& bucket : buckets_) counts.push_back(bucket.load(std::memory_order_relaxed));
  const std::uint64_t count = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  const std::uint64_t max = max_.load(std::memory_order_relaxed);
  const auto percentile = [&](double share) {
    if (count == 0) return 0.0;
    const std::uint64_t edge = Buckets::ranked(counts, nearest_rank(share, count));
    return us_per_ns * static_cast<double>(std::min(edge, max));
  };
  return {{"p50", percentile(0.5)},
          {"p99", percentile(0.99)},
          {"max", us_per_ns * static_cast<double>(max)}};
}

}  // namespace spm::servo
