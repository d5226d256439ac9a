// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "common/surface/distance_map.hpp"
#include "common/surface/tile.hpp"

namespace spm::baker {

/// The line that bounds a cell's valid part, where it is clipped.
[[nodiscard]] inline std::optional<Clip> clip_of(const Tile& tile, std::uint32_t cell) {
  if (((tile.clipped >> cell) & 1U) == 0) return std::nullopt;
  return cell_clip(tile, cell);
}

/// How far a place of a cell lies beyond the line; 0 or less on the valid side. x and y are from
/// -0.5 to 0.5, measured from the cell's middle.
[[nodiscard]] inline double beyond_clip(const Clip& clip, double x, double y) {
  return static_cast<double>(clip.a) * x + static_cast<double>(clip.b) * y -
         static_cast<double>(clip.c);
}

/// Depth below the plane and its derivatives at a place of a cell. x and y are from -0.5 to 0.5,
/// measured from the cell's middle. `heights` are those of tile_heights.
[[nodiscard]] inline Height height_at(const Tile& tile, const TileHeights& heights,
                                      std::uint32_t cell, double x, double y) {
  const std::uint32_t first = cell / tile_cells * tile_samples + cell % tile_cells;
  const auto at = [&](std::uint32_t i) { return static_cast<double>(heights[first + i]); };
  const double h00 = at(0), h10 = at(1), h01 = at(tile_samples), h11 = at(tile_samples + 1);
  const double fx = x + 0.5, fy = y + 0.5;
  const double near_row = h00 + fx * (h10 - h00);
  const double far_row = h01 + fx * (h11 - h01);
  const auto spacing = static_cast<double>(tile.spacing);
  return {tile.base + near_row + fy * (far_row - near_row),
          ((1 - fy) * (h10 - h00) + fy * (h11 - h01)) / spacing, (far_row - near_row) / spacing};
}

}  // namespace spm::baker
