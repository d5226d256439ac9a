// SPDX-License-Identifier: Apache-2.0
#include "common/paper/paper_probe_force.hpp"

#include <algorithm>
#include <cmath>

#include "common/paper/paper_force.hpp"
#include "common/paper/probe_footprint.hpp"

namespace spm {

namespace {

/// A sample of a map, and the probe's span along its ray; all in m below the support plane.
struct Column {
  ProbeSpan probe;                   ///< near: S-, far: S+
  double surface = 0;                ///< D_SP
  Vector3 normal = Vector3::Zero();  ///< n_S of eq. 5, not of unit length
};

/// The height of a map at a place. Where only some of the four samples around it met the surface,
/// the nearest one: interpolating with a miss would invent a surface. There is no slope then.
Height height_on(const DistanceMap& map, MapCell cell) noexcept {
  const Height height = height_at(map, 0, cell);
  if (std::isfinite(height.value)) return height;
  cell.column += cell.fx < 0.5 ? 0U : 1U;
  cell.row += cell.fy < 0.5 ? 0U : 1U;
  return {map.at(0, cell.column, cell.row), 0, 0};
}

/// Calls `visit` with every place in C_S, the projection of the probe on the plane closest to it,
/// where a part of the probe lies under the surface.
template <class Visit>
void visit_columns(const AssetView& asset, const ImplicitProbe& probe, const Visit& visit) {
  const Vector3 centre = probe.centre();
  if (!asset.maps_every_plane()) return;
  if (!centre.allFinite() || !probe.half_axis().allFinite()) return;
  if (!std::isfinite(probe.bounding_radius())) return;
  const std::size_t index = closest_support_plane(asset, centre);
  const SupportPlane& plane = asset.planes[index];
  const DistanceMap& map = asset.maps[index];
  const ProbeFootprint footprint(map, plane, probe);
  const double spacing = footprint.step() * map.spacing;
  const LatticeRange rows = footprint.rows();
  for (std::int64_t row = rows.first; row <= rows.last; ++row) {
    const double omega = map.omega0 + static_cast<double>(row) * spacing;
    const LatticeRange columns = footprint.columns(row);
    for (std::int64_t column = columns.first; column <= columns.last; ++column) {
      const Height height = height_on(map, footprint.cell(column, row));
      if (!std::isfinite(height.value)) continue;
      const double eta = map.eta0 + static_cast<double>(column) * spacing;
      Column found;
      found.surface = height.value;
      found.probe = probe.span(support_plane_point(plane, eta, omega), -plane.n);
      if (!found.probe.hit() || !(found.probe.far > found.surface)) continue;
      found.normal = surface_normal(plane, height.d_eta, height.d_omega);
      visit(found);
    }
  }
}

}  // namespace

PaperProbeForce paper_probe_force(const AssetView& asset, const ImplicitProbe& probe,
                                  double stiffness) noexcept {
  PaperProbeForce result;
  visit_columns(asset, probe, [&](const Column& column) {
    result.far += stiffness * (column.probe.far - column.surface) * column.normal;
    ++result.far_count;
    if (!(column.probe.near > column.surface)) return;
    result.near += stiffness * (column.probe.near - column.surface) * column.normal;
    ++result.near_count;
  });
  if (result.far_count > 0) result.far /= result.far_count;
  if (result.near_count > 0) result.near /= result.near_count;
  const double total = static_cast<double>(result.far_count) + result.near_count;
  if (total > 0) {
    result.force = result.far_count / total * result.far + result.near_count / total * result.near;
  }
  return result;
}

Vector3 paper_probe_volume_force(const AssetView& asset, const ImplicitProbe& probe,
                                 double stiffness) noexcept {
  Vector3 sum = Vector3::Zero();
  double length = 0;
  visit_columns(asset, probe, [&](const Column& column) {
    const double from = std::max(column.probe.near - column.surface, 0.0);
    const double to = column.probe.far - column.surface;
    sum += stiffness * (to * to - from * from) / 2 * column.normal;
    length += to - from;
  });
  return length > 0 ? Vector3(sum / length) : Vector3::Zero();
}

}  // namespace spm
