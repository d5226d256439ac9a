// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>

#include "servo/base/duration_buckets.hpp"

namespace spm::servo {

/// Durations that one thread counts while others may look: neither waits, and nothing is allocated
/// after construction, which a DurationHistogram does not promise. Percentiles are at most 1/32
/// above the true ones; the largest is exact.
class LatencyHistogram {
 public:
  /// By the counting thread alone: a duration, ns; a negative one counts as zero.
  void add(std::int64_t duration_ns) noexcept;

  /// `p50`, `p99` and `max` of what was counted so far, microseconds; zeros where nothing was.
  [[nodiscard]] nlohmann::ordered_json json_us() const;

 private:
  using Buckets = DurationBuckets<5>;

  std::array<std::atomic<std::uint64_t>, Buckets::count> buckets_{};
  std::atomic<std::uint64_t> max_{0};
};

}  // namespace spm::servo
