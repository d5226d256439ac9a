// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace spm {

/// What numbers that mixed_bits draws one after the other lie apart by.
inline constexpr std::uint64_t mixed_bits_step = 0x9E3779B97F4A7C15U;

/// Mixes the bits of a number, so that those of neighbours have nothing in common (splitmix64).
[[nodiscard]] inline std::uint64_t mixed_bits(std::uint64_t bits) noexcept {
  bits += mixed_bits_step;
  bits = (bits ^ (bits >> 30U)) * 0xBF58476D1CE4E5B9U;
  bits = (bits ^ (bits >> 27U)) * 0x94D049BB133111EBU;
  return bits ^ (bits >> 31U);
}

}  // namespace spm
