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
  std::array<std::int16_t, 4> wide;
  std::array<std::int8_t, 6> narrow;
  std::array<std::uint8_t, 2> last;
  std::memcpy(wide.data(), words, 8);
  std::memcpy(narrow.data(), words + 2, 6);
  std::memcpy(last.data(), reinterpret_cast<const char*>(words + 2) + 6, 2);
  LocalMap map;
  map.value = value_unit * wide[0];
  map.slope[0] = slope_unit * wide[1];
  map.slope[1] = slope_unit * wide[2];
  map.slope[2] = slope_unit * wide[3];
  // 2^(exponent - bias), by its bits: exponents of a byte cannot leave the range of doubles.
  const auto unit = std::bit_cast<double>((1023ULL + last[0] - bend_exponent_bias) << 52U);
  for (std::size_t i = 0; i < 6; ++i) map.bend[i] = unit * narrow[i];
  map.plane = last[1];
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
