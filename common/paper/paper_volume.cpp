// SPDX-License-Identifier: Apache-2.0
#include "common/paper/paper_volume.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spm {

namespace {

/// The place of M_1 that the normal of S_1 through a point meets.
struct Under {
  double depth = std::numeric_limits<double>::quiet_NaN();  ///< f of eq. 13, m
  Vector3 normal = Vector3::Zero();                         ///< n_S, not of unit length
};

Under under(const AssetView& object, std::size_t index, const Vector3& point) noexcept {
  const SupportPlane& plane = object.planes[index];
  const DistanceMap& map = object.maps[index];
  const PlaneCoordinates place = project_on_plane(plane, point);
  const MapCell cell = locate(map, place.eta, place.omega);
  if (!cell.inside) return {};
  Height height = height_at(map, 0, cell);
  if (!std::isfinite(height.value)) {
    // Beside the surface's edge the nearest sample stands for what lies about it.
    height = {};
    height.value =
        map.at(0, cell.column + (cell.fx < 0.5 ? 0 : 1), cell.row + (cell.fy < 0.5 ? 0 : 1));
  }
  return {place.depth - height.value, surface_normal(plane, height.d_eta, height.d_omega)};
}

/// What a cell of S_2 sees of M_2: the part of the cell under which there is surface, its middle,
/// in samples from the map's first, and the height there.
struct SeenCell {
  double part = 0;
  double column = 0, row = 0;
  Height height;
};

/// Samples of a map that are the corners of a cell: its first one, and how many further the others
/// are.
struct Corners {
  std::uint32_t column = 0, row = 0;
  std::uint32_t width = 1, height = 1;
};

/// The mean of four corners, and the slopes between them.
Height height_between(const DistanceMap& map, const Corners& cell) noexcept {
  const double h00 = map.at(0, cell.column, cell.row);
  const double h10 = map.at(0, cell.column + cell.width, cell.row);
  const double h01 = map.at(0, cell.column, cell.row + cell.height);
  const double h11 = map.at(0, cell.column + cell.width, cell.row + cell.height);
  const double near_row = h00 + 0.5 * (h10 - h00), far_row = h01 + 0.5 * (h11 - h01);
  Height height;
  height.value = near_row + 0.5 * (far_row - near_row);
  height.d_eta = (0.5 * (h10 - h00) + 0.5 * (h11 - h01)) / (map.spacing * cell.width);
  height.d_omega = (far_row - near_row) / (map.spacing * cell.height);
  return height;
}

/// Each sample that met the surface stands for a quarter of the cell. Without those beside an edge
/// the volume would lack half a cell along it.
SeenCell seen_cell(const DistanceMap& map, const Corners& cell) noexcept {
  SeenCell seen;
  int samples = 0;
  for (std::uint32_t corner = 0; corner < 4; ++corner) {
    const std::uint32_t right = (corner & 1U) * cell.width, up = (corner >> 1U) * cell.height;
    const float height = map.at(0, cell.column + right, cell.row + up);
    if (!std::isfinite(height)) continue;
    ++samples;
    seen.column += right;
    seen.row += up;
    seen.height.value += height;
  }
  if (samples == 0) return seen;
  seen.part = samples / 4.0;
  seen.column = cell.column + seen.column / samples;
  seen.row = cell.row + seen.row / samples;
  if (samples == 4) {
    seen.height = height_between(map, cell);
  } else {
    seen.height.value /= samples;
  }
  return seen;
}

bool usable(const AssetView& object, std::size_t plane) noexcept {
  return object.maps_every_plane() && plane < object.maps.size();
}

}  // namespace

double penetration_function(const AssetView& object1, std::size_t plane,
                            const Vector3& point) noexcept {
  if (!usable(object1, plane)) return std::numeric_limits<double>::quiet_NaN();
  return under(object1, plane, point).depth;
}

PenetrationVolume penetration_volume(const AssetView& object1, std::size_t plane1,
                                     const AssetView& object2, std::size_t plane2,
                                     const Eigen::Isometry3d& pose2, double density,
                                     AreaFactor factor, std::uint32_t stride) noexcept {
  PenetrationVolume result;
  if (!usable(object1, plane1) || !usable(object2, plane2)) return result;
  const SupportPlane& to = object1.planes[plane1];
  const SupportPlane& from = object2.planes[plane2];
  const DistanceMap& map = object2.maps[plane2];
  const double cell_area = map.spacing * map.spacing;
  const double paper_cosine = std::abs(to.n.dot(pose2.linear() * from.n));
  Vector3 moment = Vector3::Zero();
  for (std::uint32_t row = 0; row + 1 < map.rows; row += stride) {
    for (std::uint32_t column = 0; column + 1 < map.columns; column += stride) {
      const Corners cell{column, row, std::min(stride, map.columns - 1 - column),
                         std::min(stride, map.rows - 1 - row)};
      const SeenCell seen = seen_cell(map, cell);
      if (seen.part == 0) continue;
      const Height& height = seen.height;
      const double eta = map.eta0 + seen.column * map.spacing;
      const double omega = map.omega0 + seen.row * map.spacing;
      const Vector3 point = pose2 * reconstructed_surface(from, eta, omega, height.value);
      const Under found = under(object1, plane1, point);
      // Written so that a miss of either map counts for nothing.
      if (!(found.depth > 0)) continue;
      // The tangents' cross product is the area of surface per area of the plane.
      const double share =
          factor == AreaFactor::paper
              ? paper_cosine
              : -to.n.dot(pose2.linear() * surface_normal(from, height.d_eta, height.d_omega));
      const double area = seen.part * share * (cell_area * cell.width * cell.height);
      const double volume = found.depth * area;
      if (!std::isfinite(volume)) continue;
      ++result.samples;
      result.volume += volume;
      result.area += area;
      moment += volume * (point + found.depth / 2 * to.n);
      if (found.normal.allFinite()) result.normal += volume * found.normal.normalized();
    }
  }
  result.mass = density * result.volume;
  if (!(result.volume > 0)) {
    const std::size_t samples = result.samples;
    result = {};
    result.samples = samples;
    return result;
  }
  result.centre = moment / result.volume;
  const double length = result.normal.norm();
  if (length > 0) result.normal /= length;
  return result;
}

Wrench volume_wrench(const PenetrationVolume& volume, double stiffness,
                     const Vector3& about) noexcept {
  Wrench wrench;
  wrench.force = stiffness * volume.volume * volume.normal;
  wrench.torque = (volume.centre - about).cross(wrench.force);
  return wrench;
}

}  // namespace spm
