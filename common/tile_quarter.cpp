// SPDX-License-Identifier: Apache-2.0
#include "common/tile_quarter.hpp"

#include <cmath>

#include "common/cell_foot.hpp"
#include "common/quarter_feet.hpp"

namespace spm {

namespace {

/// How deep a cell lies that is not valid, spacings: its square is a float still.
constexpr float out_of_reach = 1e15F;

/// The cell of a tile that is a quarter's cell k.
std::uint32_t cell_of(std::uint32_t which, std::uint32_t k) noexcept {
  const std::uint32_t column = (which & 1U) * quarter_side + k % quarter_side;
  const std::uint32_t row = (which >> 1U) * quarter_side + k / quarter_side;
  return row * tile_cells + column;
}

}  // namespace

TileQuarter tile_quarter(const Tile& tile, float height_unit, std::uint32_t which) noexcept {
  TileHeights heights;
  tile_heights(tile, height_unit, heights);
  const float per_spacing = 1 / tile.spacing;
  TileQuarter quarter;
  for (std::uint32_t k = 0; k < quarter_cells; ++k) {
    const std::uint32_t cell = cell_of(which, k);
    if (((tile.valid >> cell) & 1U) == 0) {
      quarter.depth[k] = out_of_reach;
      continue;
    }
    const std::uint32_t first = cell / tile_cells * tile_samples + cell % tile_cells;
    const float h00 = heights[first] * per_spacing, h10 = heights[first + 1] * per_spacing,
                h01 = heights[first + tile_samples] * per_spacing,
                h11 = heights[first + tile_samples + 1] * per_spacing;
    quarter.slope_eta[k] = ((h10 - h00) + (h11 - h01)) * 0.5F;
    quarter.slope_omega[k] = ((h01 - h00) + (h11 - h10)) * 0.5F;
    quarter.twist[k] = h00 - h10 - h01 + h11;
    quarter.depth[k] = (h00 + h10 + h01 + h11) * 0.25F;
  }
  return quarter;
}

TileFoot closest_on_quarter(const Tile& tile, const TileQuarter& quarter, std::uint32_t which,
                            const SupportPlane& plane, const Vector3& point, float limit) noexcept {
  const PlaneCoordinates at = project_on_plane(plane, point);
  const double per_spacing = 1 / static_cast<double>(tile.spacing);
  const QuarterPlace place{static_cast<float>((at.eta - tile.eta0) * per_spacing) -
                               static_cast<float>((which & 1U) * quarter_side),
                           static_cast<float>((at.omega - tile.omega0) * per_spacing) -
                               static_cast<float>((which >> 1U) * quarter_side),
                           static_cast<float>((at.depth - tile.base) * per_spacing)};
  QuarterFeet feet;
  quarter_feet(quarter, place, feet);
  const auto cell_at = [&](std::uint32_t k) {
    return CellPatch{quarter.slope_eta[k],
                     quarter.slope_omega[k],
                     quarter.twist[k],
                     place.x - (static_cast<float>(k % quarter_side) + 0.5F),
                     place.y - (static_cast<float>(k / quarter_side) + 0.5F),
                     place.z - quarter.depth[k]};
  };
  const float reach = limit * static_cast<float>(per_spacing);
  const float start = reach * reach;
  float best = start;
  if (!(feet.least < start)) return {};
  std::uint32_t nearest = 0;
  for (std::uint32_t k = 0; k < quarter_cells; ++k) {
    if (!(feet.square[k] < best)) continue;
    const std::uint32_t cell = cell_of(which, k);
    if (((tile.clipped >> cell) & 1U) != 0) {
      const CellPatch patch = cell_at(k);
      if (!clip_foot(patch, cell_clip(tile, cell), 1, feet.x[k], feet.y[k])) continue;
      feet.square[k] = patch.squared_distance(feet.x[k], feet.y[k]);
      if (!(feet.square[k] < best)) continue;
    }
    best = feet.square[k];
    nearest = k;
  }
  TileFoot foot;
  if (!(best < start)) return foot;
  const CellPatch patch = cell_at(nearest);
  const float x = feet.x[nearest], y = feet.y[nearest];
  const float spacing = tile.spacing;
  foot.cell = cell_of(which, nearest);
  foot.slope_eta = patch.slope_x + patch.twist * y;
  foot.slope_omega = patch.slope_y + patch.twist * x;
  foot.away_eta = (patch.dx - x) * spacing;
  foot.away_omega = (patch.dy - y) * spacing;
  foot.away_depth = (patch.dz - patch.height(x, y)) * spacing;
  settle_foot(foot, std::sqrt(best) * spacing);
  return foot;
}

}  // namespace spm
