// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>

namespace spm {

// HALF numbers of EXR files (IEEE 754 binary16), 11 bits each, of those from least_half to
// largest_half: all that a conversion by whole numbers alone tells rightly.

inline constexpr float least_half = 0x1p-14F, largest_half = 65504;
/// What a float's exponent has more than that of a half, and its bits below those of a half.
inline constexpr std::uint32_t half_exponent = 112U << 23U, half_shift = 13;

/// The number that a half is.
[[nodiscard]] constexpr float float_of_half(std::uint16_t half) noexcept {
  return std::bit_cast<float>((std::uint32_t{half} << half_shift) + half_exponent);
}

/// The half nearest to a number from least_half to largest_half, the even one of two.
[[nodiscard]] constexpr std::uint16_t half_of(float value) noexcept {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(value) - half_exponent;
  const std::uint32_t below_half = (1U << (half_shift - 1)) - 1;
  return static_cast<std::uint16_t>((bits + below_half + (bits >> half_shift & 1U)) >> half_shift);
}

}  // namespace spm
