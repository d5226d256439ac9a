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
};

/// Quarter 0 to 3 of a tile: bit 0 the upper half along eta, 1 along omega.
[[nodiscard]] TileQuarter tile_quarter(const Tile& tile, float height_unit,
                                       std::uint32_t which) noexcept;

/// closest_on_tile among the cells of a quarter alone, with its patches at hand. Several cells at
/// once by whatever the processor has; the same bits on each.
[[nodiscard]] TileFoot closest_on_quarter(const Tile& tile, const TileQuarter& quarter,
                                          std::uint32_t which, const SupportPlane& plane,
                                          const Vector3& point, float limit) noexcept;

}  // namespace spm
