// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace spm::servo {

/// The rank, from 1 to `count`, of the value below or at which a fraction `share` of `count` values
/// lies (nearest-rank rule).
[[nodiscard]] inline std::uint64_t nearest_rank(double share, std::uint64_t count) noexcept {
  const double rank = std::ceil(share * static_cast<double>(count));
  return std::clamp<std::uint64_t>(static_cast<std::uint64_t>(rank), 1, count);
}

/// Buckets of equal relative width for durations below 2^63 ns. Values below 2^(bits + 1) have a
/// bucket each; above that, each power of two is divided into 2^bits buckets. A value is at most
/// 1/2^bits above the smallest value of its bucket.
template <unsigned bits>
struct DurationBuckets {
  static constexpr std::uint64_t first_wide = std::uint64_t{2} << bits;
  static constexpr std::size_t count = std::size_t{64 - bits} << bits;

  [[nodiscard]] static constexpr std::size_t of(std::uint64_t value) noexcept {
    if (value < first_wide) return value;
    const unsigned shift = static_cast<unsigned>(std::bit_width(value)) - 1 - bits;
    return (std::size_t{shift} << bits) + (value >> shift);
  }

  /// Largest value that a bucket holds.
  [[nodiscard]] static constexpr std::uint64_t upper_edge(std::size_t bucket) noexcept {
    if (bucket < first_wide) return bucket;
    const std::size_t shift = (bucket >> bits) - 1;
    const std::uint64_t mantissa = bucket - (shift << bits);
    return ((mantissa + 1) << shift) - 1;
  }

  /// Upper edge of the bucket that holds the value of a rank. `counts` is the number of values in
  /// each bucket.
  template <class Counts>
  [[nodiscard]] static std::uint64_t ranked(const Counts& counts, std::uint64_t rank) noexcept {
    std::uint64_t seen = 0;
    for (std::size_t bucket = 0; bucket < count; ++bucket) {
      seen += counts[bucket];
      if (seen >= rank) return upper_edge(bucket);
    }
    return upper_edge(count - 1);
  }
};

}  // namespace spm::servo
