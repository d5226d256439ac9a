// SPDX-License-Identifier: Apache-2.0
#include "common/paper/paper_probe_force.hpp"

#include <algorithm>
#include <cmath>

#include "common/paper/paper_force.hpp"

namespace spm {

namespace {

/// A sample of a map, and the probe's span along its ray; all in m below the support plane.
struct Column {
  ProbeSpan probe;     ///< near: S-, far: S+
  double surface = 0;  ///< D_SP
  Vector3 normal = Vector3::Zero();
};

/// A position in samples, clamped to those of a map.
std::uint32_t clamped(double position, std::uint32_t count) noexcept {
  return static_cast<std::uint32_t>(std::clamp(position, 0.0, static_cast<double>(count - 1)));
}

/// Calls `visit` with every sample in C_S, the projection of the probe on the plane closest to it.
template <class Visit>
void visit_columns(const AssetView& asset, const ImplicitProbe& probe, const Visit& visit) {
  const Vector3 centre = probe.centre();
  const double bounding_radius = probe.bounding_radius();
  if (!asset.maps_every_plane()) return;
  if (!centre.allFinite() || !std::isfinite(bounding_radius)) return;
  const std::size_t index = closest_support_plane(asset, centre);
  const SupportPlane& plane = asset.planes[index];
  const DistanceMap& map = asset.maps[index];
  const PlaneCoordinates middle = project_on_plane(plane, centre);
  const double x = (middle.eta - map.eta0) / map.spacing;
  const double y = (middle.omega - map.omega0) / map.spacing;
  const double wide = bounding_radius / map.spacing;
  const std::uint32_t x1 = clamped(x + wide, map.columns), y1 = clamped(y + wide, map.rows);
  for (std::uint32_t row = clamped(std::ceil(y - wide), map.rows); row <= y1; ++row) {
    for (std::uint32_t column = clamped(std::ceil(x - wide), map.columns); column <= x1; ++column) {
      Column found;
      found.surface = map.at(0, column, row);
      if (!std::isfinite(found.surface)) continue;
      const double eta = map.eta0 + column * map.spacing, omega = map.omega0 + row * map.spacing;
      found.probe = probe.span(support_plane_point(plane, eta, omega), -plane.n);
      if (!found.probe.hit() || !(found.probe.far > found.surface)) continue;
      const Height height = height_at(map, 0, locate(map, eta, omega));
      // Beside a silhouette there is no slope; the plane's own normal is the best guess.
      found.normal = std::isfinite(height.value)
                         ? surface_normal(plane, height.d_eta, height.d_omega).normalized()
                         : plane.n;
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
