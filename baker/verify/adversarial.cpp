// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/adversarial.hpp"

#include <algorithm>
#include <cmath>

#include "baker/base/random.hpp"

namespace spm::baker {

namespace {

constexpr std::uint64_t numbers = 8;  ///< random numbers for each place
/// The shortest offset, and how far the places close to the surface lie, in tolerances.
constexpr double shortest = 0.3;
constexpr double close = 1.5;

/// The random numbers of one place.
class Draw {
 public:
  Draw(std::uint64_t seed, std::uint64_t index) : seed_(seed), first_(numbers * index) {}
  [[nodiscard]] double at(std::uint64_t which) const { return random_unit(seed_, first_ + which); }

 private:
  std::uint64_t seed_, first_;
};

/// About an edge or a corner of a triangle, at a log-uniform distance.
Vector3 about_edge(const ExactSurface& surface, const AssetView& view, double tolerance,
                   const Draw& draw) {
  const double kind = draw.at(1);
  const bool corner = kind < 0.25;
  const SurfacePoint start = surface.at(draw.at(0), corner ? 0 : (kind < 0.5 ? 1 : draw.at(2)),
                                        kind < 0.75 ? draw.at(3) : 0);
  const double longest = std::max(view.band.max_depth, 2 * shortest * tolerance);
  const double offset =
      shortest * tolerance * std::pow(longest / (shortest * tolerance), draw.at(4));
  return start.position + offset * direction_of(draw.at(5), draw.at(6));
}

/// Above or below the border of a cell of a tile, within the band.
Vector3 beside_cell(const AssetView& view, const Draw& draw) {
  const auto which = static_cast<std::size_t>(draw.at(0) * static_cast<double>(view.tiles.size()));
  const Tile& tile = view.tiles[std::min(which, view.tiles.size() - 1)];
  const SupportPlane& plane = view.planes[tile.plane];
  TileHeights heights;
  tile_heights(tile, view.height_unit, heights);
  const auto column = static_cast<std::size_t>(draw.at(1) * tile_samples);
  const double row = draw.at(2) * tile_cells;
  const auto below = static_cast<std::size_t>(row);
  const double share = row - static_cast<double>(below);
  const auto at = [&](std::size_t j) {
    return static_cast<double>(
        heights[std::min<std::size_t>(j, tile_cells) * tile_samples + column]);
  };
  const auto spacing = static_cast<double>(tile.spacing);
  const double x = static_cast<double>(column) * spacing, y = row * spacing;
  const double depth = tile.base + (1 - share) * at(below) + share * at(below + 1);
  const Band& band = view.band;
  const double height = -band.max_depth + (band.max_depth + band.margin) * draw.at(3);
  return support_plane_point(plane, tile.eta0 + x, tile.omega0 + y) + (height - depth) * plane.n;
}

}  // namespace

Vector3 adversarial_place(const ExactSurface& surface, const AssetView& view, double tolerance,
                          std::uint64_t seed, std::uint64_t index) {
  const Draw draw(seed, index);
  if (index % 4 < 2) return about_edge(surface, view, tolerance, draw);
  if (index % 4 == 2 && !view.tiles.empty()) return beside_cell(view, draw);
  const SurfacePoint start = surface.at(draw.at(0), draw.at(1), draw.at(2));
  return start.position + close * tolerance * (2 * draw.at(3) - 1) * start.normal;
}

}  // namespace spm::baker
