// SPDX-License-Identifier: Apache-2.0
#include "common/cube_reach.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/closest_on_triangle.hpp"

namespace spm {

namespace {

/// What rounding to floats may move, of the cube's edge.
constexpr double rounding_share = 1e-5;

/// Cells about a foot that patches reach to.
constexpr std::array<int, 2> patch_cells{1, 3};

}  // namespace

Vector3 CubeReach::corner(unsigned which) const {
  return middle_ + Vector3((which & 1U) != 0 ? half_ : -half_, (which & 2U) != 0 ? half_ : -half_,
                           (which & 4U) != 0 ? half_ : -half_);
}

CubeReach::CubeReach(const AssetView& asset, const Vector3& middle, double half,
                     const ElementFoot& nearest)
    : middle_(middle), half_(half), nearest_(nearest.distance) {
  Vector3 foot = nearest.on_triangle;
  if (nearest.tile != nullptr) {
    const TileFoot& on = nearest.on_tile;
    foot = middle -
           from_plane_frame(asset.planes[nearest.tile->plane], static_cast<double>(on.away_eta),
                            static_cast<double>(on.away_omega), static_cast<double>(on.away_depth));
  }
  Corners corners;
  for (unsigned k = 0; k < 8; ++k) corners[k] = (corner(k) - foot).norm();
  known_.push_back(corners);
  if (nearest.tile == nullptr) return;
  for (const int cells : patch_cells) know_tile(asset, *nearest.tile, nearest.on_tile.cell, cells);
}

void CubeReach::know_tile(const AssetView& asset, const Tile& tile, std::uint32_t cell, int cells) {
  constexpr int last = static_cast<int>(tile_cells) - 1;
  const int column = static_cast<int>(cell % tile_cells), row = static_cast<int>(cell / tile_cells);
  const std::uint64_t whole = tile.valid & ~tile.clipped;
  const auto is_whole = [whole](int x0, int x1, int y0, int y1) {
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        if (((whole >> static_cast<unsigned>(y * (last + 1) + x)) & 1U) == 0) return false;
      }
    }
    return true;
  };
  int x0 = column, x1 = column, y0 = row, y1 = row;
  if (!is_whole(x0, x1, y0, y1)) return;
  for (int step = 0; step < cells; ++step) {
    if (x0 > 0 && is_whole(x0 - 1, x1, y0, y1)) --x0;
    if (x1 < last && is_whole(x0, x1 + 1, y0, y1)) ++x1;
    if (y0 > 0 && is_whole(x0, x1, y0 - 1, y1)) --y0;
    if (y1 < last && is_whole(x0, x1, y0, y1 + 1)) ++y1;
  }
  TileHeights heights;
  tile_heights(tile, asset.height_unit, heights);
  const auto height = [&heights](int x, int y) {
    return static_cast<double>(
        heights[static_cast<std::size_t>(y) * tile_samples + static_cast<std::size_t>(x)]);
  };
  // The parallelogram through the mean of the corners, and how far samples leave it.
  const double h00 = height(x0, y0), h10 = height(x1 + 1, y0), h01 = height(x0, y1 + 1),
               h11 = height(x1 + 1, y1 + 1);
  const double per_x = (h10 - h00 + h11 - h01) / 2 / (x1 + 1 - x0);
  const double per_y = (h01 - h00 + h11 - h10) / 2 / (y1 + 1 - y0);
  const double mean = (h00 + h10 + h01 + h11) / 4;
  const double middle_x = (x0 + x1 + 1) / 2.0, middle_y = (y0 + y1 + 1) / 2.0;
  const auto plane_height = [&](double x, double y) {
    return mean + (x - middle_x) * per_x + (y - middle_y) * per_y;
  };
  double thickness = 0;
  for (int y = y0; y <= y1 + 1; ++y) {
    for (int x = x0; x <= x1 + 1; ++x) {
      thickness = std::max(thickness, std::abs(height(x, y) - plane_height(x, y)));
    }
  }
  const SupportPlane& plane = asset.planes[tile.plane];
  const auto spacing = static_cast<double>(tile.spacing);
  const auto place = [&](int x, int y) {
    return Vector3(support_plane_point(plane, tile.eta0 + x * spacing, tile.omega0 + y * spacing) -
                   (tile.base + plane_height(x, y)) * plane.n);
  };
  const Vector3 a = place(x0, y0), b = place(x1 + 1, y0), c = place(x0, y1 + 1),
                d = place(x1 + 1, y1 + 1);
  Corners corners;
  for (unsigned k = 0; k < 8; ++k) {
    const Vector3 at = corner(k);
    corners[k] = thickness + std::min((at - closest_on_triangle(at, a, b, c)).norm(),
                                      (at - closest_on_triangle(at, b, c, d)).norm());
  }
  known_.push_back(corners);
}

double CubeReach::farthest(double slack) const {
  return nearest_ + 2 * std::numbers::sqrt3 * half_ + slack + rounding_share * half_;
}

bool CubeReach::may_matter(const OrientedBox& box, double slack) const {
  const Vector3 away = middle_ - box.closest(middle_);
  const double distance = away.norm();
  if (distance > farthest(slack)) return false;
  if (!(distance > 1e-9)) return true;
  const Vector3 step = half_ / distance * away;
  const double start = distance - slack - rounding_share * half_;
  Corners least;
  for (unsigned k = 0; k < 8; ++k) {
    least[k] = start + ((k & 1U) != 0 ? step.x() : -step.x()) +
               ((k & 2U) != 0 ? step.y() : -step.y()) + ((k & 4U) != 0 ? step.z() : -step.z());
  }
  for (const Corners& known : known_) {
    if ((least > known).all()) return false;
  }
  return true;
}

}  // namespace spm
