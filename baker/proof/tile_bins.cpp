// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/proof/tile_bins.hpp"

#include <algorithm>
#include <cmath>
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

Box tile_box(const SupportPlane& plane, const Tile& tile, float height_unit) {
  Box all;
  visit_boxes(plane, tile, height_unit, [&](const Box& box) {
    all.include(box.low);
    all.include(box.high);
  });
  return all;
}

TileBins::TileBins(std::span<const SupportPlane> planes, std::span<const Tile> tiles,
                   float height_unit, double edge, double reach)
    : edge_(edge) {
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Tile& tile : tiles) {
    visit_boxes(planes[tile.plane], tile, height_unit, [&](const Box& box) {
      low = low.cwiseMin(box.low);
      high = high.cwiseMax(box.high);
    });
  }
  if (!(low.x() <= high.x())) {
    starts_.assign(2, 0);
    return;
  }
  low_ = low - Vector3::Constant(reach);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int k = static_cast<int>(axis);
    count_[axis] = static_cast<std::int64_t>((high[k] - low_[k] + reach) / edge) + 1;
  }
  std::vector<std::pair<std::uint64_t, std::uint32_t>> places;
  for (std::uint32_t which = 0; which < tiles.size(); ++which) {
    visit_boxes(planes[tiles[which].plane], tiles[which], height_unit, [&](const Box& box) {
      std::array<std::int64_t, 3> from{}, to{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const int k = static_cast<int>(axis);
        const auto last = static_cast<double>(count_[axis] - 1);
        from[axis] = static_cast<std::int64_t>(
            std::clamp(std::floor((box.low[k] - reach - low_[k]) / edge), 0.0, last));
        to[axis] = static_cast<std::int64_t>(
            std::clamp(std::floor((box.high[k] + reach - low_[k]) / edge), 0.0, last));
      }
      for (std::int64_t z = from[2]; z <= to[2]; ++z) {
        for (std::int64_t y = from[1]; y <= to[1]; ++y) {
          for (std::int64_t x = from[0]; x <= to[0]; ++x) {
            places.emplace_back(static_cast<std::uint64_t>((z * count_[1] + y) * count_[0] + x),
                                which);
          }
        }
      }
    });
  }
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  starts_.assign(static_cast<std::size_t>(count_[0] * count_[1] * count_[2]) + 1, 0);
  for (const auto& place : places) ++starts_[place.first + 1];
  for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
  members_.reserve(places.size());
  for (const auto& place : places) members_.push_back(place.second);
}

std::span<const std::uint32_t> TileBins::near(const Vector3& point) const {
  std::int64_t bin = 0;
  for (std::size_t axis = 3; axis-- > 0;) {
    const int k = static_cast<int>(axis);
    const double place = std::floor((point[k] - low_[k]) / edge_);
    if (!(place >= 0 && place < static_cast<double>(count_[axis]))) return {};
    bin = bin * count_[axis] + static_cast<std::int64_t>(place);
  }
  const auto i = static_cast<std::size_t>(bin);
  return std::span(members_).subspan(starts_[i], starts_[i + 1] - starts_[i]);
}

}  // namespace spm::baker
