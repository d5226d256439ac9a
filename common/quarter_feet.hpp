// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "common/tile_quarter.hpp"

namespace spm {

/// The feet on all cells of a quarter: from the cells' middles, and squares of distances; spacings.
struct alignas(64) QuarterFeet {
  std::array<float, quarter_cells> x, y, square;
  float least;            ///< of the squares
  std::uint32_t nearest;  ///< the first cell that has it
};

/// A point in a quarter's frame, from its first sample and the tile's base; spacings.
struct QuarterPlace {
  float x, y, z;
};

/// Finds the feet of a point on all cells, each taken whole, as closest_on_tile does on one.
/// Several cells at once by whatever the processor has; the same bits on each.
void quarter_feet(const TileQuarter& quarter, const QuarterPlace& place,
                  QuarterFeet& feet) noexcept;

}  // namespace spm
