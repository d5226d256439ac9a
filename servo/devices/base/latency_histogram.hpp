// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>

#include "servo/base/duration_buckets.hpp"

namespace spm::servo {

/// Durations that one thread counts while others may read. Neither side waits, and nothing is
/// allocated after construction, which DurationHistogram does not promise. Percentiles are at most
/// 1/32 above the true ones; the maximum is exact.
class LatencyHistogram {
 public:
  /// Called by the counting thread alone, with a duration, ns; a negative one counts as zero.
  void add(std::int64_t duration_ns) noexcept;

  /// `p50`, `p99` and `max` of what was counted so far, microseconds; zeros if nothing was counted.
  [[nodiscard]] nlohmann::ordered_json json_us() const;

 private:
  using Buckets = DurationBuckets<5>;

  std::array<std::atomic<std::uint64_t>, Buckets::count> buckets_{};
  std::atomic<std::uint64_t> max_{0};
};

}  // namespace spm::servo
