// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "servo/shared/shared_layout.h"
#include "servo/base/duration_buckets.hpp"

namespace spm::servo {

// Buckets in which daemon and clients count durations: 128 ns wide up to 1 us, above that four to a
// power of two, so that a bucket's end is at most a quarter above what is in it.
using SharedBuckets = DurationBuckets<2>;
inline constexpr unsigned bucket_unit_bits = 7;

/// The bucket of a duration, ns; a negative one counts as zero, and whatever is longer than the
/// last bucket is in it.
[[nodiscard]] inline std::size_t shared_bucket(std::int64_t duration_ns) noexcept {
  const auto value = static_cast<std::uint64_t>(std::max<std::int64_t>(duration_ns, 0));
  return std::min<std::size_t>(SharedBuckets::of(value >> bucket_unit_bits), SPM_BUCKETS - 1);
}

/// The end of a bucket, ns: what is in it is shorter, but for the last one.
[[nodiscard]] inline std::uint64_t bucket_end_ns(std::size_t bucket) noexcept {
  return (SharedBuckets::upper_edge(bucket) + 1) << bucket_unit_bits;
}

}  // namespace spm::servo
