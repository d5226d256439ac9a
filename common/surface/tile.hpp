// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "common/surface/support_plane.hpp"

namespace spm {

/// Cells and samples along one side of a tile, and in the whole tile.
inline constexpr std::uint32_t tile_cells = 8;
inline constexpr std::uint32_t tile_samples = tile_cells + 1;
inline constexpr std::uint32_t tile_cell_count = tile_cells * tile_cells;
inline constexpr std::uint32_t tile_sample_count = tile_samples * tile_samples;
/// Tiles of one plane and level begin at multiples of this many cells.
inline constexpr std::uint32_t tile_stride = tile_cells / 2;

/// A small square distance map (eq. 2) of a `sparse` asset. It covers one sheet of the surface:
/// entries of rays along -n. A view that owns nothing.
///
/// Sample (column i, row j) lies at eta = eta0 + i * spacing, omega = omega0 + j * spacing. Its
/// depth below the plane is base + (slope_eta * i + slope_omega * j) * spacing + height_unit *
/// heights[j * 9 + i]. The heights are residuals from the tile's own plane, HALF floats that are
/// read in place. Between samples the depth is bilinear.
///
/// Only the cells in `valid` represent surface. Of the cells in `clipped` only the part on one side
/// of a line does; beyond the line the samples continue the sheet past a crease.
struct Tile {
  const std::uint16_t* heights = nullptr;  ///< 81, row by row
  const std::uint32_t* clips = nullptr;    ///< one word per clipped cell, in the order of the cells
  std::uint64_t valid = 0;                 ///< bit row * 8 + column
  std::uint64_t clipped = 0;               ///< subset of `valid`
  double eta0 = 0, omega0 = 0, base = 0;   ///< m
  float spacing = 0;                       ///< m
  float slope_eta = 0, slope_omega = 0;    ///< dimensionless
  std::uint32_t plane = 0;
  std::uint32_t first_layer =
      0;  ///< number of the crossing along the plane's rays, from 0; an entry

  // Derived by derive_bounds when the asset is opened.
  float highest = 0, lowest = 0;  ///< range of the residuals of the valid cells, m
  float ripple = 0;  ///< m: how far a block of 2 x 2 valid cells departs from the mean plane of its
                     ///< corners, along the rays
};

/// The line that bounds the valid part of a clipped cell: a x + b y <= c. x runs along eta and y
/// along omega, in [-0.5, 0.5] from the middle of the cell. a and b are in [-127, 127].
struct Clip {
  float a = 0, b = 0, c = 0;
};

/// Packs a line. a and b are rounded to whole numbers, and c to 1/128 ([-255, 255]).
[[nodiscard]] std::uint32_t pack_clip(const Clip& clip) noexcept;
[[nodiscard]] inline Clip unpack_clip(std::uint32_t word) noexcept {
  return {static_cast<float>(static_cast<std::int8_t>(word & 0xFFU)),
          static_cast<float>(static_cast<std::int8_t>((word >> 8U) & 0xFFU)),
          static_cast<float>(static_cast<std::int16_t>(word >> 16U)) / 128.0F};
}

/// The clip line of a clipped cell.
[[nodiscard]] inline Clip cell_clip(const Tile& tile, std::uint32_t cell) noexcept {
  const std::uint64_t before = tile.clipped & ((std::uint64_t{1} << cell) - 1);
  return unpack_clip(tile.clips[std::popcount(before)]);
}

/// HALF bits as a float. Infinities and NaN, which no valid file contains, come out as large
/// numbers.
[[nodiscard]] inline float half_to_float(std::uint16_t half) noexcept {
  const std::uint32_t magnitude = (half & 0x7FFFU) << 13U;
  const std::uint32_t sign = (half & 0x8000U) << 16U;
  return std::bit_cast<float>(
      std::bit_cast<std::uint32_t>(std::bit_cast<float>(magnitude) * 0x1p112F) | sign);
}

/// Nearest HALF of a number whose absolute value is below 65504. Below 2^-14 it becomes 0, so that
/// reading it back never meets a denormal float.
[[nodiscard]] std::uint16_t float_to_half(float value) noexcept;

/// Depths of a tile's samples below its base, m: the sums of slopes and residuals.
using TileHeights = std::array<float, tile_sample_count>;
void tile_heights(const Tile& tile, float height_unit, TileHeights& heights) noexcept;

/// Fills `highest`, `lowest` and `ripple` from the heights.
void derive_bounds(Tile& tile, float height_unit) noexcept;

}  // namespace spm
