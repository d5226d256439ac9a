// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "common/surface/support_plane.hpp"

namespace spm {

/// Sample of a distance map where the ray met no surface: plus infinity, so that no depth is
/// greater.
inline constexpr float no_hit = std::numeric_limits<float>::infinity();

/// A scalar or vectorial distance map (eq. 2) of a `full` asset: a rectangle of samples on one
/// support plane. This is a view that owns nothing; samples are read in place.
///
/// Sample (column i, row j) of a layer is the distance in metres along -n to the surface, from the
/// plane's point at eta = eta0 + i * spacing, omega = omega0 + j * spacing. Layers are the
/// crossings of one ray in order. Even layers are entries and odd layers are exits.
struct DistanceMap {
  const float* samples = nullptr;
  const std::uint32_t* layer_offsets = nullptr;  ///< per layer, in floats, from the start of a row
  const std::uint32_t* mask = nullptr;           ///< one bit per layer and cell; see cell_valid
  std::uint32_t plane = 0;
  std::uint32_t columns = 0;     ///< at least 2
  std::uint32_t rows = 0;        ///< at least 2
  std::uint32_t layers = 0;      ///< at least 1
  std::uint32_t row_stride = 0;  ///< in floats
  double eta0 = 0;
  double omega0 = 0;
  double spacing = 0;

  [[nodiscard]] float at(std::uint32_t layer, std::uint32_t column,
                         std::uint32_t row) const noexcept {
    return samples[static_cast<std::size_t>(row) * row_stride + layer_offsets[layer] + column];
  }
  [[nodiscard]] std::uint32_t cells_per_layer() const noexcept {
    return (columns - 1) * (rows - 1);
  }
  /// True where the baker found the surface continuous over the cell between four samples.
  [[nodiscard]] bool cell_valid(std::uint32_t layer, std::uint32_t column,
                                std::uint32_t row) const noexcept {
    const std::uint32_t bit = layer * cells_per_layer() + row * (columns - 1) + column;
    return ((mask[bit >> 5U] >> (bit & 31U)) & 1U) != 0;
  }
};

/// Number of 32-bit words in the mask of a map.
[[nodiscard]] constexpr std::uint32_t mask_words(std::uint32_t columns, std::uint32_t rows,
                                                 std::uint32_t layers) noexcept {
  return (layers * (columns - 1) * (rows - 1) + 31U) / 32U;
}

/// A cell of a map and a position in it, as bilinear weights fx, fy in [0, 1]. Where the point is
/// outside the map this is the nearest border cell, and the weights are clamped.
struct MapCell {
  std::uint32_t column = 0;
  std::uint32_t row = 0;
  double fx = 0;
  double fy = 0;
  bool inside = false;  ///< false where (eta, omega) was outside the map's rectangle
};

namespace detail {

struct Coordinate {
  std::uint32_t cell;
  double fraction;
  bool inside;
};

[[nodiscard]] inline Coordinate locate_along(double position, std::uint32_t samples) noexcept {
  const double last = static_cast<double>(samples - 1);
  // Written so that NaN is outside and lands in the first cell.
  if (!(position >= 0)) return {0, 0, false};
  if (position > last) return {samples - 2, 1, false};
  const auto cell = std::min(static_cast<std::uint32_t>(position), samples - 2);
  return {cell, position - cell, true};
}

}  // namespace detail

/// Finds the cell of a map at the plane parameters (eta, omega), metres. NaN gives inside = false.
[[nodiscard]] inline MapCell locate(const DistanceMap& map, double eta, double omega) noexcept {
  const detail::Coordinate along_eta =
      detail::locate_along((eta - map.eta0) / map.spacing, map.columns);
  const detail::Coordinate along_omega =
      detail::locate_along((omega - map.omega0) / map.spacing, map.rows);
  return {along_eta.cell, along_omega.cell, along_eta.fraction, along_omega.fraction,
          along_eta.inside && along_omega.inside};
}

/// The height D on the bilinear patch of a cell, and its numeric derivatives (dD/d eta and dD/d
/// omega of eq. 7 and 8, dimensionless).
struct Height {
  double value = 0;
  double d_eta = 0;
  double d_omega = 0;
};

/// D_SP and its numeric derivatives at a position in a cell.
[[nodiscard]] inline Height height_at(const DistanceMap& map, std::uint32_t layer,
                                      const MapCell& cell) noexcept {
  const double h00 = map.at(layer, cell.column, cell.row);
  const double h10 = map.at(layer, cell.column + 1, cell.row);
  const double h01 = map.at(layer, cell.column, cell.row + 1);
  const double h11 = map.at(layer, cell.column + 1, cell.row + 1);
  const double near_row = h00 + cell.fx * (h10 - h00);
  const double far_row = h01 + cell.fx * (h11 - h01);
  Height height;
  height.value = near_row + cell.fy * (far_row - near_row);
  height.d_eta = ((1 - cell.fy) * (h10 - h00) + cell.fy * (h11 - h01)) / map.spacing;
  height.d_omega = (far_row - near_row) / map.spacing;
  return height;
}

/// Surface point of the modelled object at (eta, omega), in the object's frame: eq. 4.
[[nodiscard]] inline Vector3 reconstructed_surface(const SupportPlane& plane, double eta,
                                                   double omega, double distance) noexcept {
  return support_plane_point(plane, eta, omega) - distance * plane.n;
}

/// Tangent along eta, eq. 7 (eq. 6 with n_SP constant over the plane); not of unit length.
[[nodiscard]] inline Vector3 tangent_eta(const SupportPlane& plane, double d_eta) noexcept {
  return plane.u - d_eta * plane.n;
}

/// Tangent along omega, eq. 8; not of unit length.
[[nodiscard]] inline Vector3 tangent_omega(const SupportPlane& plane, double d_omega) noexcept {
  return plane.v - d_omega * plane.n;
}

/// Tangent in the general form, eq. 6, for a basis that varies along the parameter: the derivatives
/// of the plane's surface and of its normal are arguments.
[[nodiscard]] inline Vector3 tangent_general(const Vector3& d_plane, double d_distance,
                                             const Vector3& normal, double distance,
                                             const Vector3& d_normal) noexcept {
  return d_plane - d_distance * normal - distance * d_normal;
}

/// Surface normal n_S, not normalised, pointing to the plane's side: eq. 5.
[[nodiscard]] inline Vector3 surface_normal(const SupportPlane& plane, double d_eta,
                                            double d_omega) noexcept {
  return tangent_eta(plane, d_eta).cross(tangent_omega(plane, d_omega));
}

}  // namespace spm
