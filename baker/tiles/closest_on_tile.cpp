// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/tiles/closest_on_tile.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "baker/tiles/closest_on_cell.hpp"
#include "common/surface/tile.hpp"

namespace spm::baker {

namespace {

/// Depth given to a block without valid cells, m; its square is still a finite float.
constexpr float out_of_reach = 1e15F;

using Four = Eigen::Array<float, 4, 1>;
using Lanes = float __attribute__((vector_size(16)));
using Words = std::uint32_t __attribute__((vector_size(16)));

/// A point in the frame of a tile: along eta and omega from its first sample, and below its base.
struct Local {
  float x, y, z;
};

Local local_of(const Tile& tile, const SupportPlane& plane, const Vector3& point) noexcept {
  const PlaneCoordinates place = project_on_plane(plane, point);
  return {static_cast<float>(place.eta - tile.eta0), static_cast<float>(place.omega - tile.omega0),
          static_cast<float>(place.depth - tile.base)};
}

float bound_of(const Tile& tile, const Local& p) noexcept {
  // Distance to the parallelogram of the tile's plane, minus the range of the residuals.
  const float half = tile.spacing * (static_cast<float>(tile_cells) / 2);
  const float middle = (tile.highest + tile.lowest) / 2;
  const float x = p.x - half, y = p.y - half;
  const float z = p.z - middle - (tile.slope_eta + tile.slope_omega) * half;
  const float inverse =
      1 / (1 + tile.slope_eta * tile.slope_eta + tile.slope_omega * tile.slope_omega);
  const float above = z - tile.slope_eta * x - tile.slope_omega * y;
  const float beyond_x = std::max(std::abs(x + above * inverse * tile.slope_eta) - half, 0.0F);
  const float beyond_y = std::max(std::abs(y + above * inverse * tile.slope_omega) - half, 0.0F);
  return std::sqrt(above * above * inverse + beyond_x * beyond_x + beyond_y * beyond_y) -
         (tile.highest - tile.lowest) / 2;
}

/// The blocks of 2 x 2 cells in which a tile is searched, row by row.
constexpr std::uint32_t tile_blocks = 16;

using Blocks = Eigen::Array<float, tile_blocks, 1>;

/// The mean planes of a tile's blocks over their footprints: depth below the base in the middle, m,
/// and slopes along eta and omega; and how far the valid surface departs from them, m. A block
/// without valid cells is put too far away for any query.
struct BlockPlanes {
  std::array<float, tile_blocks> depth, slope_eta, slope_omega, ripple;
};

BlockPlanes block_planes(const Tile& tile, float height_unit) noexcept {
  TileHeights heights;
  tile_heights(tile, height_unit, heights);
  const float per_slope = 0.25F / tile.spacing;
  BlockPlanes planes;
  for (std::uint32_t k = 0; k < tile_blocks; ++k) {
    const std::uint32_t first = (k >> 2U) * (2 * tile_samples) + (k & 3U) * 2;
    const auto sample = [&](std::uint32_t i, std::uint32_t j) {
      return heights[first + j * tile_samples + i];
    };
    const float a = sample(0, 0), b = sample(2, 0), c = sample(0, 2), d = sample(2, 2);
    const std::uint64_t cells = std::uint64_t{0x303} << ((k >> 2U) * 16 + (k & 3U) * 2);
    if ((tile.valid & cells) == 0) {
      planes.depth[k] = out_of_reach;
      planes.slope_eta[k] = planes.slope_omega[k] = planes.ripple[k] = 0;
      continue;
    }
    planes.slope_eta[k] = ((b - a) + (d - c)) * per_slope;
    planes.slope_omega[k] = ((c - a) + (d - b)) * per_slope;
    planes.depth[k] = (a + b + c + d) * 0.25F;
    float ripple = 0, most = 0;
    for (std::uint32_t j = 0; j < 3; ++j) {
      for (std::uint32_t i = 0; i < 3; ++i) {
        const float plane =
            planes.depth[k] + ((static_cast<float>(i) - 1) * planes.slope_eta[k] +
                               (static_cast<float>(j) - 1) * planes.slope_omega[k]) *
                                  tile.spacing;
        ripple = std::max(ripple, std::abs(sample(i, j) - plane));
        most = std::max(most, std::abs(sample(i, j)));
      }
    }
    // Rounding must not make the bound invalid.
    planes.ripple[k] = ripple + 1e-5F * (tile.spacing + most);
  }
  return planes;
}

/// Lower bounds of the distance to the valid surface of each block, m; below 0 where it is close.
Blocks block_bounds(const Tile& tile, const BlockPlanes& planes, const Local& p) noexcept {
  static const Blocks x = [] {
    Blocks middles;
    for (std::uint32_t k = 0; k < tile_blocks; ++k)
      middles[k] = static_cast<float>(2 * (k & 3U) + 1);
    return middles;
  }();
  static const Blocks y = [] {
    Blocks middles;
    for (std::uint32_t k = 0; k < tile_blocks; ++k)
      middles[k] = static_cast<float>(2 * (k >> 2U) + 1);
    return middles;
  }();
  const float s = tile.spacing;
  const Eigen::Map<const Blocks> depth(planes.depth.data()), slope_x(planes.slope_eta.data()),
      slope_y(planes.slope_omega.data());
  const Blocks dx = p.x - x * s;
  const Blocks dy = p.y - y * s;
  const Blocks above = (p.z - depth) - slope_x * dx - slope_y * dy;
  const Blocks along = above / (slope_x * slope_x + slope_y * slope_y + 1.0F);
  const Blocks beyond_x = ((dx + along * slope_x).abs() - s).max(0.0F);
  const Blocks beyond_y = ((dy + along * slope_y).abs() - s).max(0.0F);
  const Eigen::Map<const Blocks> ripple(planes.ripple.data());
  return (above * along + beyond_x * beyond_x + beyond_y * beyond_y).sqrt() - ripple;
}

/// Three HALF samples as floats, as half_to_float gives them; the fourth is unused.
Lanes three_halves(const std::uint16_t* half) noexcept {
  std::uint32_t low;
  std::memcpy(&low, half, sizeof(low));
  const Words bits = Words{low, low >> 16U, half[2], 0} & 0xFFFFU;
  const Lanes magnitude = std::bit_cast<Lanes>((bits & 0x7FFFU) << 13U) * 0x1p112F;
  return std::bit_cast<Lanes>(std::bit_cast<Words>(magnitude) | (bits & 0x8000U) << 16U);
}

/// Four samples of a row as depths below the tile's base; the last of them is unused.
Lanes block_row(const Tile& tile, float height_unit, std::uint32_t column,
                std::uint32_t row) noexcept {
  const Lanes heights = three_halves(tile.heights + std::size_t{row} * tile_samples + column);
  const float step_eta = tile.slope_eta * tile.spacing;
  const float step_omega = tile.slope_omega * tile.spacing;
  const auto x = static_cast<float>(column);
  const Lanes along = Lanes{x, x + 1, x + 2, 0} * step_eta;
  return heights * height_unit + (along + static_cast<float>(row) * step_omega);
}

Four four_of(Lanes lanes) noexcept { return {lanes[0], lanes[1], lanes[2], lanes[3]}; }

/// Closest points on the four cells of a block; keeps the nearest in `closest_point`.
void visit_block(const Tile& tile, float height_unit, const Local& p, std::uint32_t block,
                 TileClosestPoint& closest_point, float& best) noexcept {
  const std::uint32_t column = (block & 3U) * 2, row = (block >> 2U) * 2;
  const Lanes first = block_row(tile, height_unit, column, row);
  const Lanes second = block_row(tile, height_unit, column, row + 1);
  const Lanes third = block_row(tile, height_unit, column, row + 2);
  // Order of the cells: lower left, lower right, upper left, upper right.
  const Four h00 = four_of(__builtin_shufflevector(first, second, 0, 1, 4, 5));
  const Four h10 = four_of(__builtin_shufflevector(first, second, 1, 2, 5, 6));
  const Four h01 = four_of(__builtin_shufflevector(second, third, 0, 1, 4, 5));
  const Four h11 = four_of(__builtin_shufflevector(second, third, 1, 2, 5, 6));
  const auto x0 = static_cast<float>(column) + 0.5F, y0 = static_cast<float>(row) + 0.5F;
  const Four middle_x{x0, x0 + 1, x0, x0 + 1}, middle_y{y0, y0, y0 + 1, y0 + 1};
  const float s = tile.spacing, half = s / 2;
  const float per_slope = 0.5F / s;
  const Four slope_x = ((h10 - h00) + (h11 - h01)) * per_slope;
  const Four slope_y = ((h01 - h00) + (h11 - h10)) * per_slope;
  const Four twist = (h00 - h10 - h01 + h11) / (s * s);
  const Four dx = p.x - middle_x * s;
  const Four dy = p.y - middle_y * s;
  const Four dz = p.z - (h00 + h10 + h01 + h11) * 0.25F;
  const Four along =
      (dz - slope_x * dx - slope_y * dy) / (slope_x * slope_x + slope_y * slope_y + 1.0F);
  // The minimum over a rectangle lies on a side beyond which the unconstrained minimum is: one side
  // of each direction is tried.
  const Four x1 = (dx + along * slope_x).max(-half).min(half);
  const Four y2 = (dy + along * slope_y).max(-half).min(half);
  const Four y1 =
      ((dy + slope_y * (dz - slope_x * x1)) / (slope_y * slope_y + 1.0F)).max(-half).min(half);
  const Four x2 =
      ((dx + slope_x * (dz - slope_y * y2)) / (slope_x * slope_x + 1.0F)).max(-half).min(half);
  const Four below1 = dz - slope_x * x1 - slope_y * y1 - twist * x1 * y1;
  const Four below2 = dz - slope_x * x2 - slope_y * y2 - twist * x2 * y2;
  const Four square1 = (dx - x1) * (dx - x1) + (dy - y1) * (dy - y1) + below1 * below1;
  const Four square2 = (dx - x2) * (dx - x2) + (dy - y2) * (dy - y2) + below2 * below2;
  for (std::uint32_t k = 0; k < 4; ++k) {
    float square = std::min(square1[k], square2[k]);
    if (!(square < best)) continue;
    const std::uint32_t index = (row + (k >> 1U)) * tile_cells + column + (k & 1U);
    if (((tile.valid >> index) & 1U) == 0) continue;
    float x = square1[k] <= square2[k] ? x1[k] : x2[k];
    float y = square1[k] <= square2[k] ? y1[k] : y2[k];
    const CellPatch cell{slope_x[k], slope_y[k], twist[k], dx[k], dy[k], dz[k]};
    if (((tile.clipped >> index) & 1U) != 0) {
      if (!clip_closest_point(cell, cell_clip(tile, index), s, x, y)) continue;
      square = cell.squared_distance(x, y);
      if (!(square < best)) continue;
    }
    best = square;
    closest_point.cell = index;
    closest_point.slope_eta = cell.slope_x + cell.twist * y;
    closest_point.slope_omega = cell.slope_y + cell.twist * x;
    closest_point.away_eta = cell.dx - x;
    closest_point.away_omega = cell.dy - y;
    closest_point.away_depth = cell.dz - cell.height(x, y);
  }
}

/// Fills in what follows from the position of the closest point: its distance (m), and how far the
/// query point is below the surface.
void settle_closest_point(TileClosestPoint& closest_point, float distance) noexcept {
  closest_point.distance = distance;
  const float level = std::sqrt(1 + closest_point.slope_eta * closest_point.slope_eta +
                                closest_point.slope_omega * closest_point.slope_omega);
  closest_point.below =
      (closest_point.away_depth - closest_point.slope_eta * closest_point.away_eta -
       closest_point.slope_omega * closest_point.away_omega) /
      level;
}

}  // namespace

TileClosestPoint closest_on_tile(const Tile& tile, float height_unit, const SupportPlane& plane,
                                 const Vector3& point, float limit) noexcept {
  TileClosestPoint closest_point;
  const Local p = local_of(tile, plane, point);
  if (!(bound_of(tile, p) < limit)) return closest_point;
  Blocks bounds = block_bounds(tile, block_planes(tile, height_unit), p);
  float best = limit * limit;
  const float start = best;
  for (std::uint32_t visited = 0; visited < tile_blocks; ++visited) {
    Eigen::Index nearest = 0;
    const float bound = bounds.minCoeff(&nearest);
    if (!(bound < 0) && !(bound * bound < best)) break;
    bounds[nearest] = std::numeric_limits<float>::infinity();
    visit_block(tile, height_unit, p, static_cast<std::uint32_t>(nearest), closest_point, best);
  }
  if (best < start) settle_closest_point(closest_point, std::sqrt(best));
  return closest_point;
}

}  // namespace spm::baker
