// SPDX-License-Identifier: Apache-2.0
#include "common/paper/probe_footprint.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace spm {

namespace {

/// A place on the rim may be lost to rounding otherwise; it is asked for its span all the same.
constexpr double rounding = 1e-9;
/// No lattice is finer: a probe a millionth of a sample wide is a point.
constexpr double finest = 0x1p20;

/// Distance of the places in samples, for a projection of that radius and half length, in samples.
double step_of(double radius, double half, std::uint32_t columns, std::uint32_t rows) noexcept {
  const double flat = std::numbers::pi * radius * radius + 4 * half * radius;
  const double area = std::min(flat, static_cast<double>(columns) * rows);
  const double long_side = std::min<double>(2 * (radius + half), std::max(columns, rows));
  // A long thin probe has its bound in its length.
  const double least = std::max(long_side / most_probe_samples, 1 / finest);
  const double coarser = std::max(std::sqrt(area / most_probe_samples), least);
  const double finer = std::max(2 * radius / least_probe_samples_across, coarser);
  // Written so that NaN, of no probe, is the map's own lattice.
  if (coarser > 1) return coarser;
  return finer < 1 ? finer : 1;
}

}  // namespace

ProbeFootprint::ProbeFootprint(const DistanceMap& map, const SupportPlane& plane,
                               const ImplicitProbe& probe) noexcept
    : columns_(map.columns), rows_(map.rows) {
  const PlaneCoordinates middle = project_on_plane(plane, probe.centre());
  const Vector3 half = probe.half_axis();
  x_ = (middle.eta - map.eta0) / map.spacing;
  y_ = (middle.omega - map.omega0) / map.spacing;
  along_x_ = half.dot(plane.u) / map.spacing;
  along_y_ = half.dot(plane.v) / map.spacing;
  radius_ = probe.bounding_radius() / map.spacing;
  step_ = step_of(radius_, std::hypot(along_x_, along_y_), columns_, rows_);
}

LatticeRange ProbeFootprint::between(double from, double to, std::uint32_t samples) const noexcept {
  const double last = static_cast<double>(samples - 1);
  // Written so that NaN gives no place.
  if (!(to >= 0 && from <= last && from <= to)) return {};
  return {static_cast<std::int64_t>(std::ceil(std::max(from - rounding, 0.0) / step_)),
          static_cast<std::int64_t>(std::floor(std::min(to + rounding, last) / step_))};
}

LatticeRange ProbeFootprint::rows() const noexcept {
  const double reach = std::abs(along_y_) + radius_;
  return between(y_ - reach, y_ + reach, rows_);
}

// The projection is all that lies within the radius of a segment. It is convex, so a row of it
// runs from the first of its parts' slices to the last: of the two discs, and of the two straight
// sides.
LatticeRange ProbeFootprint::columns(std::int64_t row) const noexcept {
  const double down = static_cast<double>(row) * step_ - y_;
  double from = std::numeric_limits<double>::infinity(), to = -from;
  const auto include = [&](double low, double high) {
    from = std::min(from, low);
    to = std::max(to, high);
  };
  for (const double side : {-1.0, 1.0}) {
    const double above = down - side * along_y_;
    const double square = radius_ * radius_ - above * above;
    if (!(square >= 0)) continue;
    const double half = std::sqrt(square);
    include(side * along_x_ - half, side * along_x_ + half);
  }
  const double length = std::hypot(along_x_, along_y_);
  if (length > 0 && along_y_ != 0) {
    for (const double side : {-radius_ / length, radius_ / length}) {
      const double part = (down - side * along_x_) / along_y_;
      const double place = part * along_x_ - side * along_y_;
      if (part >= -1 && part <= 1) include(place, place);
    }
  }
  return between(x_ + from, x_ + to, columns_);
}

MapCell ProbeFootprint::cell(std::int64_t column, std::int64_t row) const noexcept {
  const auto x = detail::locate_along(static_cast<double>(column) * step_, columns_);
  const auto y = detail::locate_along(static_cast<double>(row) * step_, rows_);
  return {x.cell, y.cell, x.fraction, y.fraction, x.inside && y.inside};
}

}  // namespace spm
