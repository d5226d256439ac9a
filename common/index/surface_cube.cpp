// SPDX-License-Identifier: Apache-2.0
#include "common/index/surface_cube.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/surface/closest_on_tile.hpp"

namespace spm {

namespace {

/// What rounding to floats may move, of the cube's edge.
constexpr double rounding_share = 1e-5;

Vector3 step_to(unsigned corner, double half) {
  return {(corner & 1U) != 0 ? half : -half, (corner & 2U) != 0 ? half : -half,
          (corner & 4U) != 0 ? half : -half};
}

/// How far a tile's surface leaves its tangent plane at a closest point, along the tile's rays,
/// within a radius, m; nothing where some of that is not there.
std::optional<double> ripple_about(const AssetView& asset, const Tile& tile, const Vector3& point,
                                   const TileClosestPoint& closest_point, double radius) {
  const SupportPlane& plane = asset.planes[tile.plane];
  const PlaneCoordinates at = project_on_plane(plane, point);
  const double spacing = double{tile.spacing};
  const double x = (at.eta - tile.eta0 - double{closest_point.away_eta}) / spacing;
  const double y = (at.omega - tile.omega0 - double{closest_point.away_omega}) / spacing;
  const double depth = at.depth - tile.base - double{closest_point.away_depth};
  const double radius_in_cells = radius / spacing;
  const auto first = [](double value) { return static_cast<int>(std::floor(value)); };
  const int x0 = first(x - radius_in_cells), x1 = first(x + radius_in_cells),
            y0 = first(y - radius_in_cells), y1 = first(y + radius_in_cells);
  if (x0 < 0 || y0 < 0 || x1 >= static_cast<int>(tile_cells) ||
      y1 >= static_cast<int>(tile_cells)) {
    return std::nullopt;
  }
  const std::uint64_t whole = tile.valid & ~tile.clipped;
  for (int row = y0; row <= y1; ++row) {
    for (int column = x0; column <= x1; ++column) {
      const unsigned cell = static_cast<unsigned>(row) * tile_cells + static_cast<unsigned>(column);
      if (((whole >> cell) & 1U) == 0) return std::nullopt;
    }
  }
  TileHeights heights;
  tile_heights(tile, asset.height_unit, heights);
  double most = 0;
  for (int row = y0; row <= y1 + 1; ++row) {
    for (int column = x0; column <= x1 + 1; ++column) {
      const auto sample =
          static_cast<std::size_t>(row) * tile_samples + static_cast<std::size_t>(column);
      const double tangent = depth + (double{closest_point.slope_eta} * (column - x) +
                                      double{closest_point.slope_omega} * (row - y)) *
                                         spacing;
      most = std::max(most, std::abs(double{heights[sample]} - tangent));
    }
  }
  return most;
}

}  // namespace

SurfaceCube surface_cube(const AssetView& asset, const Vector3& middle, double half,
                         const ElementClosestPoint& nearest) {
  SurfaceCube cube;
  cube.middle = from_origin(asset.bvh, middle);
  cube.half = static_cast<float>(half);
  Vector3 away = middle - nearest.on_triangle;
  if (nearest.tile != nullptr) {
    const TileClosestPoint& on = nearest.on_tile;
    away = from_plane_frame(asset.planes[nearest.tile->plane], double{on.away_eta},
                            double{on.away_omega}, double{on.away_depth});
  }
  const double rounding = rounding_share * half;
  for (unsigned k = 0; k < 8; ++k) {
    cube.known[0][k] = static_cast<float>((away + step_to(k, half)).norm() + rounding);
  }
  cube.known[1] = cube.known[0];
  if (nearest.tile == nullptr) return cube;
  const TileClosestPoint& on = nearest.on_tile;
  const auto ripple =
      ripple_about(asset, *nearest.tile, middle, on, std::numbers::sqrt3 * half + rounding);
  if (!ripple) return cube;
  const Vector3 normal = surface_normal(asset.planes[nearest.tile->plane], double{on.slope_eta},
                                        double{on.slope_omega})
                             .normalized();
  for (unsigned k = 0; k < 8; ++k) {
    const double height = normal.dot(away + step_to(k, half));
    cube.known[1][k] = static_cast<float>(std::abs(height) + *ripple + rounding);
  }
  return cube;
}

}  // namespace spm
