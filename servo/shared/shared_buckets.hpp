// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "servo/base/duration_buckets.hpp"
#include "servo/shared/shared_layout.h"

namespace spm::servo {

// Buckets in which daemon and clients count durations. They are 128 ns wide up to 1 us; above that
// there are four to each power of two, so that a bucket's end is at most a quarter above the values
// in it.
using SharedBuckets = DurationBuckets<2>;
inline constexpr unsigned bucket_unit_bits = 7;

/// The bucket of a duration, ns. A negative one counts as zero; one that is too long is in the last
/// bucket.
[[nodiscard]] inline std::size_t shared_bucket(std::int64_t duration_ns) noexcept {
  const auto value = static_cast<std::uint64_t>(std::max<std::int64_t>(duration_ns, 0));
  return std::min<std::size_t>(SharedBuckets::of(value >> bucket_unit_bits), SPM_BUCKETS - 1);
}

/// The end of a bucket, ns: the values in it are smaller, except in the last one.
[[nodiscard]] inline std::uint64_t bucket_end_ns(std::size_t bucket) noexcept {
  return (SharedBuckets::upper_edge(bucket) + 1) << bucket_unit_bits;
}

}  // namespace spm::servo
