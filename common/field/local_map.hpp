// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "common/base/vector.hpp"
#include "common/surface/support_plane.hpp"

namespace spm {

/// A local distance map in closed form: the signed distance within a cube, in the frame of the
/// support plane that faces the surface there.
///
/// With z the place from the cube's middle along u, v and -n of the plane, over half the cube's
/// edge, so that z[2] grows with S_SP (eq. 3), and h half the edge:
///   distance = h (value + slope . z + z' bend z).
/// The terms in z[0] and z[1] alone are D_SP(P_M), a quadratic distance map about the middle; -z[2]
/// is S_SP; what else there is in z[2] is a correction that grows with depth, since the surface is
/// inclined against the plane (eq. 9) and curved.
struct LocalMap {
  double value = 0;
  Vector3 slope = Vector3::Zero();
  std::array<double, 6> bend{};  ///< 00, 11, 22, and of 01, 02, 12 the sum of both entries
  std::uint32_t plane = 0;       ///< row of the plane table, below 256

  [[nodiscard]] double at(const Vector3& z) const noexcept {
    return value + z[0] * (slope[0] + bend[0] * z[0] + bend[3] * z[1] + bend[4] * z[2]) +
           z[1] * (slope[1] + bend[1] * z[1] + bend[5] * z[2]) + z[2] * (slope[2] + bend[2] * z[2]);
  }
  [[nodiscard]] Vector3 gradient(const Vector3& z) const noexcept {
    return {slope[0] + 2 * bend[0] * z[0] + bend[3] * z[1] + bend[4] * z[2],
            slope[1] + 2 * bend[1] * z[1] + bend[3] * z[0] + bend[5] * z[2],
            slope[2] + 2 * bend[2] * z[2] + bend[4] * z[0] + bend[5] * z[1]};
  }
};

/// A local map as the file stores it. Words of a file, which may be anything: each gives finite
/// numbers.
///   words 0 and 1: value, slope along u, v and -n, 16 bits each, signed;
///   words 2 and 3: the six of bend, 8 bits each, signed; the exponent of their unit; the plane.
struct PackedLocalMap {
  std::array<std::uint32_t, 4> words{};
};

inline constexpr std::size_t local_map_words = 4;

/// Units of the packed numbers, but for `value`, whose unit is the caller's: the octree's
/// value_unit over half the cube's edge.
inline constexpr double slope_unit = 1.0 / 16384;
inline constexpr int bend_exponent_bias = 40;

[[nodiscard]] inline LocalMap unpack_local_map(const std::uint32_t* words,
                                               double value_unit) noexcept {
  // By lanes: one by one, the numbers would take as long as all the rest of a query.
  using Longs = std::int64_t __attribute__((vector_size(16)));
  using Lanes = std::int32_t __attribute__((vector_size(16)));
  using Shorts = std::int16_t __attribute__((vector_size(16)));
  using Bytes = std::int8_t __attribute__((vector_size(16)));
  using Two = double __attribute__((vector_size(16)));
  using Four = double __attribute__((vector_size(32)));
  // Each number is doubled until it is the top of a lane, and goes down with its sign.
  const auto low = [](Shorts x) {
    return std::bit_cast<Lanes>(__builtin_shufflevector(x, x, 0, 0, 1, 1, 2, 2, 3, 3));
  };
  const auto high = [](Shorts x) {
    return std::bit_cast<Lanes>(__builtin_shufflevector(x, x, 4, 4, 5, 5, 6, 6, 7, 7));
  };
  std::array<std::int64_t, 2> halves;
  std::memcpy(halves.data(), words, sizeof halves);
  const Lanes wide = low(std::bit_cast<Shorts>(Longs{halves[0], 0})) >> 16;
  const auto bytes = std::bit_cast<Bytes>(Longs{halves[1], 0});
  const auto narrow = std::bit_cast<Shorts>(
      __builtin_shufflevector(bytes, bytes, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7));
  const Four first =
      Four{value_unit, slope_unit, slope_unit, slope_unit} * __builtin_convertvector(wide, Four);
  // 2^(exponent - bias), by its bits: exponents of a byte cannot leave the range of doubles.
  const auto last = static_cast<std::uint64_t>(halves[1]) >> 48U;
  const auto unit = static_cast<std::int64_t>((1023U + (last & 0xFFU) - bend_exponent_bias) << 52U);
  const auto units = reinterpret_cast<Two>(Longs{unit, unit});
  const Lanes more = high(narrow) >> 24;
  const Four bend = __builtin_shufflevector(units, units, 0, 1, 2, 3) *
                    __builtin_convertvector(low(narrow) >> 24, Four);
  const Two bend_on =
      units * __builtin_convertvector(__builtin_shufflevector(more, more, 0, 1), Two);
  LocalMap map;
  map.value = first[0];
  map.slope[0] = first[1];
  map.slope[1] = first[2];
  map.slope[2] = first[3];
  std::memcpy(map.bend.data(), &bend, sizeof bend);
  std::memcpy(map.bend.data() + 4, &bend_on, sizeof bend_on);
  map.plane = static_cast<std::uint32_t>(last >> 8U);
  return map;
}

/// The nearest packed map; empty where a number is too large for its bits.
[[nodiscard]] bool pack_local_map(const LocalMap& map, double value_unit,
                                  PackedLocalMap& packed) noexcept;

/// A place from a cube's middle, over half the cube's edge, in the coordinates of a local map.
[[nodiscard]] inline Vector3 local_coordinates(const SupportPlane& plane,
                                               const Vector3& offset) noexcept {
  const double x = offset[0], y = offset[1], z = offset[2];
  return {plane.u[0] * x + plane.u[1] * y + plane.u[2] * z,
          plane.v[0] * x + plane.v[1] * y + plane.v[2] * z,
          -(plane.n[0] * x + plane.n[1] * y + plane.n[2] * z)};
}

}  // namespace spm
