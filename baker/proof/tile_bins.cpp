// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/proof/tile_bins.hpp"

#include <algorithm>
#include <limits>

namespace spm::baker {

namespace {

/// Boxes around the valid cells of a tile, one for each block of 2 x 2.
template <class Visit>
void visit_boxes(const SupportPlane& plane, const Tile& tile, float height_unit,
                 const Visit& visit) {
  TileHeights heights;
  tile_heights(tile, height_unit, heights);
  const auto spacing = static_cast<double>(tile.spacing);
  for (std::uint32_t block = 0; block < tile_cell_count / 4; ++block) {
    const std::uint32_t column = block % 4 * 2, row = block / 4 * 2;
    const std::uint64_t cells = std::uint64_t{0x303} << (row * 8 + column);
    if ((tile.valid & cells) == 0) continue;
    Box box;
    for (std::uint32_t k = 0; k < 9; ++k) {
      const std::uint32_t x = column + k % 3, y = row + k / 3;
      const Vector3 point =
          support_plane_point(plane, tile.eta0 + x * spacing, tile.omega0 + y * spacing) -
          (tile.base + static_cast<double>(heights[y * tile_samples + x])) * plane.n;
      box.include(point);
    }
    visit(box);
  }
}

}  // namespace

TileBins::TileBins(std::span<const SupportPlane> planes, std::span<const Tile> tiles,
                   float height_unit, double edge, double radius) {
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Tile& tile : tiles) {
    visit_boxes(planes[tile.plane], tile, height_unit, [&](const Box& box) {
      low = low.cwiseMin(box.low);
      high = high.cwiseMax(box.high);
    });
  }
  if (!(low.x() <= high.x())) return;
  const Vector3 around = Vector3::Constant(radius);
  low -= around;
  grid_ = CubeGrid(low, high - low + around, edge);
  std::vector<CubeBins::Member> members;
  for (std::uint32_t which = 0; which < tiles.size(); ++which) {
    visit_boxes(planes[tiles[which].plane], tiles[which], height_unit, [&](const Box& box) {
      const auto from = grid_.nearest(box.low - around), to = grid_.nearest(box.high + around);
      for (std::int64_t z = from[2]; z <= to[2]; ++z) {
        for (std::int64_t y = from[1]; y <= to[1]; ++y) {
          for (std::int64_t x = from[0]; x <= to[0]; ++x) {
            members.emplace_back(grid_.number(x, y, z), which);
          }
        }
      }
    });
  }
  std::sort(members.begin(), members.end());
  members.erase(std::unique(members.begin(), members.end()), members.end());
  bins_ = CubeBins(grid_.cubes(), members);
}

std::span<const std::uint32_t> TileBins::near(const Vector3& point) const {
  const auto cube = grid_.find(point);
  if (!cube) return {};
  return bins_.of(*cube, *cube);
}

}  // namespace spm::baker
