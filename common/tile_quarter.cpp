// SPDX-License-Identifier: Apache-2.0
#include "common/tile_quarter.hpp"

#include <cmath>
#include <limits>

#include "common/cell_foot.hpp"
#include "common/quarter_feet.hpp"

namespace spm {

namespace {

/// How deep a cell lies that is not valid, spacings: its square is a float still.
constexpr float out_of_reach = 1e15F;

}  // namespace

TileQuarter tile_quarter(const Tile& tile, float height_unit, const SupportPlane& plane,
                         std::uint32_t which) noexcept {
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
  const auto spacing = static_cast<double>(tile.spacing);
  const std::uint32_t column = (which & 1U) * quarter_side, row = (which >> 1U) * quarter_side;
  quarter.spacing = tile.spacing;
  quarter.origin =
      support_plane_point(plane, tile.eta0 + column * spacing, tile.omega0 + row * spacing) -
      tile.base * plane.n;
  for (int k = 0; k < 3; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    quarter.axes[0][axis] = static_cast<float>(plane.u[k] / spacing);
    quarter.axes[1][axis] = static_cast<float>(plane.v[k] / spacing);
    quarter.axes[2][axis] = static_cast<float>(-plane.n[k] / spacing);
  }
  return quarter;
}

TileFoot closest_on_quarter(const Tile& tile, const TileQuarter& quarter, std::uint32_t which,
                            const Vector3& point, float limit) noexcept {
  // From the origin in floats: near it they are exact enough.
  const auto x0 = static_cast<float>(point.x() - quarter.origin.x());
  const auto y0 = static_cast<float>(point.y() - quarter.origin.y());
  const auto z0 = static_cast<float>(point.z() - quarter.origin.z());
  const auto along = [&](const std::array<float, 3>& axis) {
    return axis[0] * x0 + axis[1] * y0 + axis[2] * z0;
  };
  const QuarterPlace place{along(quarter.axes[0]), along(quarter.axes[1]), along(quarter.axes[2])};
  QuarterFeet feet;
  quarter_feet(quarter, place, feet);
  TileFoot foot;
  const float spacing = quarter.spacing;
  if (!(feet.least * (spacing * spacing) < limit * limit)) return foot;
  const auto cell_at = [&](std::uint32_t k) {
    return CellPatch{quarter.slope_eta[k],
                     quarter.slope_omega[k],
                     quarter.twist[k],
                     place.x - (static_cast<float>(k % quarter_side) + 0.5F),
                     place.y - (static_cast<float>(k / quarter_side) + 0.5F),
                     place.z - quarter.depth[k]};
  };
  std::uint32_t nearest = feet.nearest;
  float best = feet.least;
  if (((tile.clipped >> cell_of(which, nearest)) & 1U) != 0) {
    best = std::numeric_limits<float>::infinity();
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
    if (!(best * (spacing * spacing) < limit * limit)) return foot;
  }
  const CellPatch patch = cell_at(nearest);
  const float x = feet.x[nearest], y = feet.y[nearest];
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
