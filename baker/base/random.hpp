// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "common/base/vector.hpp"

namespace spm::baker {

/// Counter-based random numbers (splitmix64's finaliser, Steele, Lea, Flood 2014): the value
/// depends on the seed and the index alone, so threads may draw in any order.
[[nodiscard]] constexpr std::uint64_t random_bits(std::uint64_t seed,
                                                  std::uint64_t index) noexcept {
  std::uint64_t bits = seed * 0xD1342543DE82EF95ULL + (index + 1) * 0x9E3779B97F4A7C15ULL;
  bits = (bits ^ (bits >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  bits = (bits ^ (bits >> 27U)) * 0x94D049BB133111EBULL;
  return bits ^ (bits >> 31U);
}

/// Uniform in [0, 1).
[[nodiscard]] constexpr double random_unit(std::uint64_t seed, std::uint64_t index) noexcept {
  return static_cast<double>(random_bits(seed, index) >> 11U) * 0x1p-53;
}

/// A unit vector, uniform on the sphere for `a` and `b` uniform in [0, 1).
[[nodiscard]] inline Vector3 direction_of(double a, double b) noexcept {
  const double z = 2 * a - 1, turn = 2 * std::numbers::pi * b;
  const double flat = std::sqrt(std::max(0.0, 1 - z * z));
  return {flat * std::cos(turn), flat * std::sin(turn), z};
}

}  // namespace spm::baker
