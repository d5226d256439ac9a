// SPDX-License-Identifier: Apache-2.0
#include "common/element_units.hpp"

#include <array>
#include <limits>
#include <utility>

#include "common/closest_element.hpp"

namespace spm {

namespace {

/// Cells along a side of a block: its box is thinner than its quarter's.
constexpr std::uint32_t block_side = 2;

/// Axes of which the last is along a normal.
Eigen::Matrix3d axes_along(const Vector3& normal, const Vector3& side) {
  const Vector3 across = side - side.dot(normal) * normal;
  if (!(across.norm() > 1e-6 * side.norm())) return Eigen::Matrix3d::Identity();
  const Vector3 u = across.normalized();
  Eigen::Matrix3d axes;
  axes << u, normal.cross(u), normal;
  return axes;
}

/// The box around places, its last axis along a normal (unit).
OrientedBox box_around(const std::vector<Vector3>& places, const Vector3& normal,
                       const Vector3& side) {
  const Eigen::Matrix3d axes = axes_along(normal, side);
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Vector3& place : places) {
    low = low.cwiseMin(axes.transpose() * place);
    high = high.cwiseMax(axes.transpose() * place);
  }
  return {axes * ((low + high) / 2), axes, (high - low) / 2};
}

/// A block's cells that have surface; none where it has none.
struct BlockSurface {
  std::vector<Vector3> corners;  ///< of the cells; bilinear patches lie within their hull
  std::vector<Vector3> normals;
};

BlockSurface surface_of(const Tile& tile, const SupportPlane& plane, const TileHeights& heights,
                        std::uint32_t first_column, std::uint32_t first_row) {
  const auto spacing = static_cast<double>(tile.spacing);
  const auto place = [&](std::uint32_t column, std::uint32_t row) {
    return Vector3(
        support_plane_point(plane, tile.eta0 + column * spacing, tile.omega0 + row * spacing) -
        (tile.base + static_cast<double>(heights[row * tile_samples + column])) * plane.n);
  };
  BlockSurface surface;
  for (std::uint32_t row = first_row; row < first_row + block_side; ++row) {
    for (std::uint32_t column = first_column; column < first_column + block_side; ++column) {
      if (((tile.valid >> (row * tile_cells + column)) & 1U) == 0) continue;
      const std::array around{place(column, row), place(column + 1, row), place(column, row + 1),
                              place(column + 1, row + 1)};
      surface.corners.insert(surface.corners.end(), around.begin(), around.end());
      surface.normals.emplace_back(
          (around[3] - around[0]).cross(around[2] - around[1]).normalized());
    }
  }
  return surface;
}

std::vector<ElementUnit> blocks_of(const AssetView& asset, std::uint32_t number) {
  const Tile& tile = asset.tiles[number];
  const SupportPlane& plane = asset.planes[tile.plane];
  TileHeights heights;
  tile_heights(tile, asset.height_unit, heights);
  std::vector<ElementUnit> units;
  for (std::uint32_t row = 0; row < tile_cells; row += block_side) {
    for (std::uint32_t column = 0; column < tile_cells; column += block_side) {
      BlockSurface surface = surface_of(tile, plane, heights, column, row);
      if (surface.corners.empty()) continue;
      Vector3 normal = Vector3::Zero();
      for (const Vector3& one : surface.normals) normal += one;
      const std::uint32_t quarter = row / quarter_side * 2 + column / quarter_side;
      units.push_back({{number, quarter},
                       box_around(surface.corners, normal.normalized(), plane.u),
                       std::move(surface.normals),
                       false});
    }
  }
  return units;
}

std::vector<ElementUnit> triangles_of(const AssetView& asset, const TreeChild& fan) {
  std::vector<ElementUnit> units;
  for (std::uint32_t k = 0; k < fan.count; ++k) {
    Vector3 a, b, c;
    if (!stored_corner(asset, fan.first, a) || !stored_corner(asset, fan.first + k + 1, b) ||
        !stored_corner(asset, fan.first + k + 2, c)) {
      break;
    }
    const Vector3 across = (b - a).cross(c - a);
    const bool flat = across.norm() > 0;
    const Vector3 normal = flat ? Vector3(across.normalized()) : Vector3(Vector3::UnitZ());
    // One without a normal tells no side.
    std::vector<Vector3> normals(flat ? 1 : 0, normal);
    units.push_back({{fan.first, (fan.first + k + 1) | index_triangle},
                     box_around({a, b, c}, normal, b - a),
                     std::move(normals),
                     fan.first >= asset.first_cap});
  }
  return units;
}

}  // namespace

std::vector<ElementUnit> units_of(const AssetView& asset, const TreeChild& element) {
  if (element.kind == ElementKind::fan) return triangles_of(asset, element);
  if (element.kind != ElementKind::tile || element.first >= asset.tiles.size()) return {};
  return blocks_of(asset, element.first);
}

}  // namespace spm
