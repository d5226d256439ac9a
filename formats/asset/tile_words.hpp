// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/surface/tile.hpp"
#include "formats/asset/asset.hpp"

namespace spm {

// The data of a tile beside its heights, as words of the parts `grid_tiles` and `grid_masks`.
// `grid_tiles` has tile_words words per tile:
//   0: bits 0-11 the plane, 12-15 the level, 16-23 the first layer, 24 set where not every cell is
//      valid, 25 set where some cell is clipped;
//   1: column, and row in the high half, 16 bits each, signed;
//   2: the base, a float;
//   3: slope_eta, and slope_omega in the high half, both HALF.
// `grid_masks` has, one tile after the other: where bit 24 is set `valid`, two words, low first;
// where bit 25 is set `clipped`, two words, and then one clip per set bit.

inline constexpr std::uint32_t tile_words = 4;
inline constexpr std::uint32_t max_tile_planes = 1U << 12U;
inline constexpr std::uint32_t max_tile_levels = 12;
inline constexpr std::uint32_t max_tile_layers = 1U << 8U;

/// The words of both parts.
struct TileWords {
  std::vector<std::uint32_t> tiles, masks;
};
[[nodiscard]] TileWords words_of(const std::vector<TileData>& tiles);

/// A view of the heights and clips of `data` as a tile; its bounds are not derived yet.
[[nodiscard]] Tile tile_over(const TileData& data, double tile_spacing) noexcept;

/// The problem of a tile that cannot be stored or contradicts itself; empty where there is none.
[[nodiscard]] std::string tile_problem(const TileData& tile, std::size_t planes);

/// Tiles without heights, with their clips read in place, and the number of words of `masks` they
/// took.
struct TilesRead {
  std::vector<Tile> tiles;
  std::size_t mask_words = 0;
  std::string problem;  ///< the error in the words; empty where there is none
};
[[nodiscard]] TilesRead read_tiles(std::span<const std::uint32_t> words,
                                   std::span<const std::uint32_t> masks, double tile_spacing,
                                   std::size_t planes);

/// True for a HALF that is a number: neither infinite nor NaN.
[[nodiscard]] constexpr bool half_is_finite(std::uint16_t half) noexcept {
  return (half & 0x7C00U) != 0x7C00U;
}

}  // namespace spm
