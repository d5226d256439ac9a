// SPDX-License-Identifier: Apache-2.0
#include "common/surface/closest_on_map.hpp"

#include <cmath>

namespace spm {

namespace {

/// Closest points this far beyond valid cells still count, in cells: adjacent cells of two maps
/// must leave no gap.
constexpr double border_slack = 0.03;

/// Masked cells steeper than this join two sheets of surface.
constexpr double silhouette_slope = 1.5;
/// Part of the spacing by which a masked point must be closer than every valid one.
constexpr double masked_share = 0.1;
/// Added to a rank, m: farther than any surface.
constexpr double last_rank = 1e6;

/// A step shorter than this part of the spacing changes nothing that the samples resolve.
constexpr double settled_share = 1e-3;

/// Derivatives of the height field, continuous across the borders of cells. At each sample: the
/// mean of the differences to both sides, where the cells there are valid. Between samples:
/// bilinear.
Height smooth_derivatives(const DistanceMap& map, std::uint32_t layer,
                          const MapCell& cell) noexcept {
  const std::uint32_t c = cell.column, r = cell.row;
  double h[4][4] = {};
  const auto read = [&](int i, int j) {
    h[i][j] =
        map.at(layer, c + static_cast<std::uint32_t>(i) - 1, r + static_cast<std::uint32_t>(j) - 1);
  };
  for (int i = 1; i < 3; ++i) {
    for (int j = 1; j < 3; ++j) read(i, j);
  }
  const bool before_eta = c > 0 && map.cell_valid(layer, c - 1, r);
  const bool after_eta = c + 2 < map.columns && map.cell_valid(layer, c + 1, r);
  const bool before_omega = r > 0 && map.cell_valid(layer, c, r - 1);
  const bool after_omega = r + 2 < map.rows && map.cell_valid(layer, c, r + 1);
  double eta[2][2], omega[2][2];  // derivative at each corner, times the spacing
  for (int k = 0; k < 2; ++k) {
    const double across = h[2][k + 1] - h[1][k + 1];
    const double along = h[k + 1][2] - h[k + 1][1];
    eta[0][k] = eta[1][k] = across;
    omega[k][0] = omega[k][1] = along;
    if (before_eta) read(0, k + 1), eta[0][k] = (across + h[1][k + 1] - h[0][k + 1]) / 2;
    if (after_eta) read(3, k + 1), eta[1][k] = (across + h[3][k + 1] - h[2][k + 1]) / 2;
    if (before_omega) read(k + 1, 0), omega[k][0] = (along + h[k + 1][1] - h[k + 1][0]) / 2;
    if (after_omega) read(k + 1, 3), omega[k][1] = (along + h[k + 1][3] - h[k + 1][2]) / 2;
  }
  const auto blend = [&](const double(&d)[2][2]) {
    return ((1 - cell.fx) * ((1 - cell.fy) * d[0][0] + cell.fy * d[0][1]) +
            cell.fx * ((1 - cell.fy) * d[1][0] + cell.fy * d[1][1])) /
           map.spacing;
  };
  return {0, blend(eta), blend(omega)};
}

/// True where the closest point's cell is valid, or one that the point nearly touches.
bool valid_nearby(const DistanceMap& map, std::uint32_t layer, const MapCell& cell) noexcept {
  if (map.cell_valid(layer, cell.column, cell.row)) return true;
  if (cell.fx < border_slack && cell.column > 0) {
    if (map.cell_valid(layer, cell.column - 1, cell.row)) return true;
  }
  if (cell.fx > 1 - border_slack && cell.column + 2 < map.columns) {
    if (map.cell_valid(layer, cell.column + 1, cell.row)) return true;
  }
  if (cell.fy < border_slack && cell.row > 0) {
    if (map.cell_valid(layer, cell.column, cell.row - 1)) return true;
  }
  if (cell.fy > 1 - border_slack && cell.row + 2 < map.rows) {
    if (map.cell_valid(layer, cell.column, cell.row + 1)) return true;
  }
  return false;
}

}  // namespace

MapClosestPoint closest_on_map(const DistanceMap& map, std::uint32_t layer,
                               const SupportPlane& plane, const Vector3& point) noexcept {
  const PlaneCoordinates target = project_on_plane(plane, point);
  const double enough = settled_share * map.spacing;
  double eta = target.eta;
  double omega = target.omega;
  MapCell cell;
  Height height;
  for (int step = 0; step <= closest_point_steps; ++step) {
    cell = locate(map, eta, omega);
    height = height_at(map, layer, cell);
    eta = map.eta0 + (cell.column + cell.fx) * map.spacing;
    omega = map.omega0 + (cell.row + cell.fy) * map.spacing;
    if (step == closest_point_steps) break;
    const double below = target.depth - height.value - height.d_eta * (target.eta - eta) -
                         height.d_omega * (target.omega - omega);
    const double along_normal =
        below / (1 + height.d_eta * height.d_eta + height.d_omega * height.d_omega);
    const double next_eta = target.eta + along_normal * height.d_eta;
    const double next_omega = target.omega + along_normal * height.d_omega;
    if (std::abs(next_eta - eta) + std::abs(next_omega - omega) < enough) break;
    eta = next_eta;
    omega = next_omega;
  }

  MapClosestPoint closest_point;
  closest_point.cell = cell;
  const double d_eta = target.eta - eta;
  const double d_omega = target.omega - omega;
  const double d_depth = target.depth - height.value;
  const double length = std::sqrt(d_eta * d_eta + d_omega * d_omega + d_depth * d_depth);
  const double below = d_depth - height.d_eta * d_eta - height.d_omega * d_omega;
  closest_point.distance = below > 0 ? -length : length;
  closest_point.valid = valid_nearby(map, layer, cell);
  closest_point.rank = length;
  if (!closest_point.valid) {
    const bool steep = std::abs(height.d_eta) + std::abs(height.d_omega) > silhouette_slope;
    closest_point.rank += steep ? last_rank : masked_share * map.spacing;
  }
  return closest_point;
}

Vector3 normal_at(const DistanceMap& map, std::uint32_t layer, const SupportPlane& plane,
                  const MapCell& cell) noexcept {
  const Height smooth = smooth_derivatives(map, layer, cell);
  return surface_normal(plane, smooth.d_eta, smooth.d_omega).normalized();
}

}  // namespace spm
