// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/trials/border_trials.hpp"

#include <algorithm>
#include <cmath>

#include "baker/tiles/tile_cells.hpp"
#include "common/base/random.hpp"

namespace spm::baker {

namespace {

constexpr std::uint64_t numbers = 6;  ///< random numbers for each point
/// Smallest and largest distance of places from the line, in tolerances. Distances are log-uniform.
constexpr double min_tolerances = 0.25;
constexpr double max_tolerances = 4;

}  // namespace

BorderTrials::BorderTrials(const AssetView& asset, std::uint64_t seed)
    : asset_(asset), seed_(seed) {
  for (std::uint32_t tile = 0; tile < asset.tiles.size(); ++tile) {
    for (std::uint32_t cell = 0; cell < tile_cell_count; ++cell) {
      if (((asset.tiles[tile].clipped >> cell) & 1U) != 0) cells_.emplace_back(tile, cell);
    }
  }
}

Vector3 BorderTrials::point(std::uint64_t index) const {
  const auto random = [&](std::uint64_t k) { return random_unit(seed_, numbers * index + k); };
  const auto entry = static_cast<std::size_t>(random(0) * static_cast<double>(cells_.size()));
  const auto [which, cell] = cells_[std::min(entry, cells_.size() - 1)];
  const Tile& tile = asset_.tiles[which];
  const Clip clip = clip_of(tile, cell).value_or(Clip{});
  double x = random(1) - 0.5, y = random(2) - 0.5;
  // Onto the line, as far as the line is in the cell.
  const auto a = static_cast<double>(clip.a), b = static_cast<double>(clip.b);
  const double square = a * a + b * b;
  if (square > 0) {
    const double beyond = beyond_clip(clip, x, y) / square;
    x = std::clamp(x - beyond * a, -0.5, 0.5);
    y = std::clamp(y - beyond * b, -0.5, 0.5);
  }
  TileHeights heights;
  tile_heights(tile, asset_.height_unit, heights);
  const SupportPlane& plane = asset_.planes[tile.plane];
  const auto spacing = static_cast<double>(tile.spacing);
  const double eta = tile.eta0 + (cell % tile_cells + 0.5 + x) * spacing;
  const double omega = tile.omega0 + (cell / tile_cells + 0.5 + y) * spacing;
  const Vector3 place =
      support_plane_point(plane, eta, omega) - height_at(tile, heights, cell, x, y).value * plane.n;
  const double away =
      min_tolerances * asset_.tolerance * std::pow(max_tolerances / min_tolerances, random(5));
  return place + away * direction_of(random(3), random(4));
}

}  // namespace spm::baker
