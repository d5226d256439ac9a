// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "common/tile.hpp"

namespace spm {

/// Quarters of a tile, and cells along a side of one and in all.
inline constexpr std::uint32_t tile_quarters = 4;
inline constexpr std::uint32_t quarter_side = tile_cells / 2;
inline constexpr std::uint32_t quarter_cells = quarter_side * quarter_side;

/// The bilinear patches of a quarter's cells about their middles, row by row, with the spacing as
/// the unit: slopes of the mean plane along eta and omega, twist h00 - h10 - h01 + h11, and depth
/// of the middle below the tile's base. A cell that is not valid is out of all reach. Derived from
/// the heights, so that all cells are looked at together.
struct alignas(64) TileQuarter {
  std::array<float, quarter_cells> slope_eta{}, slope_omega{}, twist{}, depth{};
  Vector3 origin = Vector3::Zero();  ///< the quarter's first sample, at the tile's base, m
  /// Along eta, omega and depth, per spacing: a point's places in the quarter are their products
  /// with what it is from the origin.
  std::array<std::array<float, 3>, 3> axes{};
  float spacing = 0;  ///< m
};

/// The cell of a tile that is cell k of a quarter.
[[nodiscard]] constexpr std::uint32_t cell_of(std::uint32_t which, std::uint32_t k) noexcept {
  const std::uint32_t column = (which & 1U) * quarter_side + k % quarter_side;
  const std::uint32_t row = (which >> 1U) * quarter_side + k / quarter_side;
  return row * tile_cells + column;
}

/// Quarter 0 to 3 of a tile: bit 0 the upper half along eta, 1 along omega.
[[nodiscard]] TileQuarter tile_quarter(const Tile& tile, float height_unit,
                                       const SupportPlane& plane, std::uint32_t which) noexcept;

/// closest_on_tile among the cells of a quarter alone, with its patches at hand.
[[nodiscard]] TileFoot closest_on_quarter(const Tile& tile, const TileQuarter& quarter,
                                          std::uint32_t which, const Vector3& point,
                                          float limit) noexcept;

}  // namespace spm
