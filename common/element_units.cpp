// SPDX-License-Identifier: Apache-2.0
#include "common/element_units.hpp"

#include <array>
#include <limits>
#include <utility>

#include "common/closest_element.hpp"

namespace spm {

namespace {

/// Axes of which the last is along a normal.
Eigen::Matrix3d axes_along(const Vector3& normal, const Vector3& side) {
  const Vector3 across = side - side.dot(normal) * normal;
  if (!(across.norm() > 1e-6 * side.norm())) return Eigen::Matrix3d::Identity();
  const Vector3 u = across.normalized();
  Eigen::Matrix3d axes;
  axes << u, normal.cross(u), normal;
  return axes;
}

std::vector<ElementUnit> quarters_of(const AssetView& asset, std::uint32_t number) {
  const Tile& tile = asset.tiles[number];
  const SupportPlane& plane = asset.planes[tile.plane];
  TileHeights heights;
  tile_heights(tile, asset.height_unit, heights);
  const auto spacing = static_cast<double>(tile.spacing);
  std::vector<ElementUnit> units;
  for (std::uint32_t quarter = 0; quarter < tile_quarters; ++quarter) {
    // Bilinear patches lie within their corners' hull.
    std::vector<Vector3> corners;
    std::vector<Vector3> normals;
    Vector3 normal = Vector3::Zero();
    for (std::uint32_t k = 0; k < quarter_cells; ++k) {
      const std::uint32_t column = (quarter & 1U) * quarter_side + k % quarter_side;
      const std::uint32_t row = (quarter >> 1U) * quarter_side + k / quarter_side;
      if (((tile.valid >> (row * tile_cells + column)) & 1U) == 0) continue;
      const auto place = [&](std::uint32_t x, std::uint32_t y) {
        return Vector3(
            support_plane_point(plane, tile.eta0 + (column + x) * spacing,
                                tile.omega0 + (row + y) * spacing) -
            (tile.base + static_cast<double>(heights[(row + y) * tile_samples + column + x])) *
                plane.n);
      };
      const std::array around{place(0, 0), place(1, 0), place(0, 1), place(1, 1)};
      corners.insert(corners.end(), around.begin(), around.end());
      normals.emplace_back((around[3] - around[0]).cross(around[2] - around[1]).normalized());
      normal += normals.back();
    }
    if (corners.empty()) continue;
    normal.normalize();
    units.push_back({{number, quarter}, box_around(corners, normal, plane.u), normals, false});
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

std::vector<ElementUnit> units_of(const AssetView& asset, const TreeChild& element) {
  if (element.kind == ElementKind::fan) return triangles_of(asset, element);
  if (element.kind != ElementKind::tile || element.first >= asset.tiles.size()) return {};
  return quarters_of(asset, element.first);
}

}  // namespace spm
