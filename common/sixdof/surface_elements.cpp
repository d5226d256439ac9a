// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/surface_elements.hpp"

#include <algorithm>
#include <limits>

#include "common/surface/distance_map.hpp"

namespace spm {

namespace {

/// A box around a tile's valid cells.
void tile_box(const AssetView& asset, const Tile& tile, Vector3& low, Vector3& high) {
  const SupportPlane& plane = asset.planes[tile.plane];
  TileHeights heights;
  tile_heights(tile, asset.height_unit, heights);
  const auto spacing = static_cast<double>(tile.spacing);
  for (std::uint32_t cell = 0; cell < tile_cell_count; ++cell) {
    if (((tile.valid >> cell) & 1U) == 0) continue;
    for (std::uint32_t corner = 0; corner < 4; ++corner) {
      const std::uint32_t column = cell % tile_cells + corner % 2;
      const std::uint32_t row = cell / tile_cells + corner / 2;
      const double depth = tile.base + static_cast<double>(heights[row * tile_samples + column]);
      const Vector3 place = reconstructed_surface(plane, tile.eta0 + column * spacing,
                                                  tile.omega0 + row * spacing, depth);
      low = low.cwiseMin(place);
      high = high.cwiseMax(place);
    }
  }
}

}  // namespace

SurfaceElements::SurfaceElements(const AssetView& asset) {
  std::vector<Node> leaves;
  const Vector3 far = Vector3::Constant(std::numeric_limits<double>::max());
  const auto add = [&](const SurfaceElement& element, const Vector3& low, const Vector3& high) {
    leaves.push_back({low, high, true, static_cast<std::uint32_t>(elements_.size()), 0});
    elements_.push_back(element);
  };
  for (std::size_t i = 0; i < asset.exact.size(); ++i) {
    if (!traits_of(asset.exact, i).bare) continue;
    SurfaceElement element;
    element.corners = corners_of(asset.exact, i);
    Vector3 low = far, high = -far;
    for (const Vector3& corner : element.corners) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
    add(element, low, high);
  }
  for (std::uint32_t i = 0; i < asset.tiles.size(); ++i) {
    if (asset.tiles[i].plane >= asset.planes.size()) continue;
    SurfaceElement element;
    element.is_tile = true;
    element.number = i;
    Vector3 low = far, high = -far;
    tile_box(asset, asset.tiles[i], low, high);
    add(element, low, high);
  }
  if (leaves.empty()) return;
  nodes_.reserve(2 * leaves.size());
  static_cast<void>(build(leaves, 0, leaves.size()));
}

std::uint32_t SurfaceElements::build(std::vector<Node>& leaves, std::size_t first,
                                     std::size_t last) {
  const auto number = static_cast<std::uint32_t>(nodes_.size());
  if (last - first == 1) {
    nodes_.push_back(leaves[first]);
    return number;
  }
  Node node = leaves[first];
  for (std::size_t i = first; i < last; ++i) {
    node.low = node.low.cwiseMin(leaves[i].low);
    node.high = node.high.cwiseMax(leaves[i].high);
  }
  int axis = 0;
  (node.high - node.low).maxCoeff(&axis);
  const std::size_t middle = first + (last - first) / 2;
  const auto at = [&](std::size_t i) { return leaves.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(first), at(middle), at(last), [&](const Node& a, const Node& b) {
    const double x = a.low[axis] + a.high[axis], y = b.low[axis] + b.high[axis];
    return x != y ? x < y : a.first < b.first;
  });
  node.leaf = false;
  nodes_.push_back(node);
  const std::uint32_t left = build(leaves, first, middle);
  const std::uint32_t right = build(leaves, middle, last);
  nodes_[number].first = left;
  nodes_[number].second = right;
  return number;
}

}  // namespace spm
