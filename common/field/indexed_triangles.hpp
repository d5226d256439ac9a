// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "common/base/vector.hpp"
#include "common/field/feature_sides.hpp"

namespace spm {

/// Bits of a corner's coordinate, and of a corner's number.
inline constexpr unsigned corner_bits = 21;
inline constexpr std::uint32_t corner_mask = (1U << corner_bits) - 1;

/// The exact triangles of a `sparse` asset, as an indexed mesh. Views; nothing is owned.
///
/// Corners lie on one lattice. Those that are close in space are close in memory, and so are
/// triangles. The numbers are little-endian:
///   corners: 64 bits each: x, y and z, corner_bits each, lattice steps from `origin`, x lowest;
///   triangles: 64 bits each: the numbers of three corners, corner_bits each, the first lowest; the
///     last bit is set where single precision will not do (thin). The first side, from corner 0 to
///     corner 1, is the shortest;
///   sides: 16 bits each, one a triangle: its FeatureSides; bit 15 set for triangles that are no
///     surface and are only crossed (TriangleList).
///
/// Words may be anything, in a file that was damaged after it was checked, so each number is
/// checked before it is used.
struct IndexedTriangles {
  Vector3 origin = Vector3::Zero();
  double step = 1;  ///< of the lattice, m
  std::span<const std::uint32_t> corners, triangles, sides;

  [[nodiscard]] std::size_t corner_count() const noexcept { return corners.size() / 2; }
  /// Triangles that are there whole.
  [[nodiscard]] std::size_t size() const noexcept {
    return triangles.size() / 2 < 2 * sides.size() ? triangles.size() / 2 : 2 * sides.size();
  }
};

/// 64 bits of a triangle or corner; `number` must be below their number.
[[nodiscard]] inline std::uint64_t long_word(std::span<const std::uint32_t> words,
                                             std::size_t number) noexcept {
  std::uint64_t word = 0;
  std::memcpy(&word, words.data() + 2 * number, sizeof word);
  return word;
}

/// Three numbers of corner_bits in one word.
[[nodiscard]] constexpr std::uint64_t pack_three(const std::array<std::uint32_t, 3>& numbers,
                                                 bool last_bit = false) noexcept {
  return std::uint64_t{numbers[0]} | std::uint64_t{numbers[1]} << corner_bits |
         std::uint64_t{numbers[2]} << 2 * corner_bits | std::uint64_t{last_bit ? 1U : 0U} << 63U;
}
[[nodiscard]] constexpr std::uint32_t unpack_third(std::uint64_t word, unsigned which) noexcept {
  return static_cast<std::uint32_t>(word >> which * corner_bits) & corner_mask;
}
[[nodiscard]] constexpr bool is_thin(std::uint64_t triangle) noexcept {
  return triangle >> 63U != 0;
}

/// The corners of a triangle, m. A corner that is not there is at the origin.
[[nodiscard]] inline std::array<Vector3, 3> corners_of(const IndexedTriangles& mesh,
                                                       std::size_t triangle) noexcept {
  const std::uint64_t numbers = long_word(mesh.triangles, triangle);
  std::array<Vector3, 3> corners;
  for (unsigned k = 0; k < 3; ++k) {
    const std::uint32_t number = unpack_third(numbers, k);
    const std::uint64_t at = number < mesh.corner_count() ? long_word(mesh.corners, number) : 0;
    corners[k] = {mesh.origin[0] + mesh.step * unpack_third(at, 0),
                  mesh.origin[1] + mesh.step * unpack_third(at, 1),
                  mesh.origin[2] + mesh.step * unpack_third(at, 2)};
  }
  return corners;
}

/// What is kept of a triangle besides its corners.
struct TriangleTraits {
  FeatureSides sides = 0;
  bool crossed = false;
};

[[nodiscard]] constexpr std::uint32_t pack_traits(const TriangleTraits& traits) noexcept {
  return std::uint32_t{traits.sides} | (traits.crossed ? 1U << 15U : 0U);
}
[[nodiscard]] inline TriangleTraits traits_of(const IndexedTriangles& mesh,
                                              std::size_t triangle) noexcept {
  const std::uint32_t bits = mesh.sides[triangle / 2] >> 16U * (triangle % 2);
  return {.sides = static_cast<FeatureSides>(bits & 0x3FFFU), .crossed = (bits >> 15U & 1U) != 0};
}

}  // namespace spm
