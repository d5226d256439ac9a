// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "common/base/vector.hpp"

namespace spm {

/// The step from one number of splitmix64's sequence to the next, before their bits are mixed.
inline constexpr std::uint64_t mixed_bits_step = 0x9E3779B97F4A7C15U;

/// Mixes the bits of a number, so that those of neighbours have nothing in common: one step of
/// splitmix64 (Steele, Lea and Flood 2014).
[[nodiscard]] constexpr std::uint64_t mixed_bits(std::uint64_t bits) noexcept {
  bits += mixed_bits_step;
  bits = (bits ^ (bits >> 30U)) * 0xBF58476D1CE4E5B9U;
  bits = (bits ^ (bits >> 27U)) * 0x94D049BB133111EBU;
  return bits ^ (bits >> 31U);
}

/// The upper 53 bits as a number in [0, 1).
[[nodiscard]] constexpr double unit_of_bits(std::uint64_t bits) noexcept {
  return static_cast<double>(bits >> 11U) * 0x1p-53;
}

/// Counter-based random bits: they depend on the seed and the index alone, so threads may draw in
/// any order.
[[nodiscard]] constexpr std::uint64_t random_bits(std::uint64_t seed,
                                                  std::uint64_t index) noexcept {
  return mixed_bits(seed * 0xD1342543DE82EF95U + index * mixed_bits_step);
}

/// Counter-based, uniform in [0, 1).
[[nodiscard]] constexpr double random_unit(std::uint64_t seed, std::uint64_t index) noexcept {
  return unit_of_bits(random_bits(seed, index));
}

/// A unit vector, uniform on the sphere for `a` and `b` uniform in [0, 1).
[[nodiscard]] inline Vector3 direction_of(double a, double b) noexcept {
  const double z = 2 * a - 1, turn = 2 * std::numbers::pi * b;
  const double flat = std::sqrt(1 - z * z);
  return {flat * std::cos(turn), flat * std::sin(turn), z};
}

/// A number of the normal distribution, mean 0 and standard deviation 1, for `a` and `b` uniform in
/// [0, 1) (Box and Muller).
[[nodiscard]] inline double normal_of(double a, double b) noexcept {
  return std::sqrt(-2 * std::log(1 - a)) * std::cos(2 * std::numbers::pi * b);
}

/// A sequence of random numbers that is the same on every machine (splitmix64).
class Random {
 public:
  explicit Random(std::uint64_t seed) noexcept : state_(seed) {}

  [[nodiscard]] std::uint64_t next() noexcept {
    const std::uint64_t bits = mixed_bits(state_);
    state_ += mixed_bits_step;
    return bits;
  }

  /// Uniform between two bounds.
  [[nodiscard]] double between(double low, double high) noexcept {
    return low + (high - low) * unit_of_bits(next());
  }

  /// Normally distributed, mean 0 and standard deviation 1.
  [[nodiscard]] double normal() noexcept {
    const double a = unit_of_bits(next());
    return normal_of(a, unit_of_bits(next()));
  }

  /// A unit vector, uniform on the sphere.
  [[nodiscard]] Vector3 direction() noexcept {
    const double a = unit_of_bits(next());
    return direction_of(a, unit_of_bits(next()));
  }

 private:
  std::uint64_t state_;
};

}  // namespace spm
