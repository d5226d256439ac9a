// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/trials/direction_error.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "baker/trials/band_trials.hpp"
#include "common/query/query.hpp"
#include "common/surface/closest_on_triangle.hpp"

namespace spm::baker {

namespace {

constexpr std::uint64_t trials = 20000;
/// One of three trials of BandTrials lies anywhere over the band.
constexpr std::uint64_t every = 3, first = 1;
/// Nearer to the surface than this, in tolerances, a direction means nothing.
constexpr double min_tolerances = 0.05;

/// A triangle faces a place directly within this cosine.
constexpr double facing_cosine = 1 - 1e-9;
/// Two triangles compete where their directions from the place differ by more than this.
constexpr double competing_cosine = 0.996;  // 5 degrees
/// How much farther than the nearest a triangle may be and still compete, in tolerances.
constexpr double competing_tolerances = 2;

/// True where one triangle faces a place directly and no triangle in another direction competes.
bool uncontested(const Caster& caster, const Vector3& point, const ClosestPoint& closest,
                 double tolerance) {
  if (std::abs(closest.direction.dot(caster.normal(closest.triangle))) < facing_cosine) {
    return false;
  }
  std::vector<std::uint32_t> near;
  const double away = std::abs(closest.distance);
  caster.within(point, away + competing_tolerances * tolerance, near);
  const Vector3 toward = (closest.closest_point - point) / away;
  return std::none_of(near.begin(), near.end(), [&](std::uint32_t triangle) {
    if (caster.is_cap(triangle)) return false;
    const Vector3 other =
        closest_on_triangle(point, caster.corner(triangle, 0), caster.corner(triangle, 1),
                            caster.corner(triangle, 2)) -
        point;
    const double distance = other.norm();
    return toward.dot(other) < competing_cosine * distance &&
           std::abs(caster.normal(triangle).dot(other)) > facing_cosine * distance;
  });
}

}  // namespace

double median_direction_error(const Asset& asset, const Caster& caster, std::uint64_t seed) {
  const AssetTables tables = tables_of(asset);
  const AssetView& view = tables.view();
  const BandTrials band(caster, view.band, view.tolerance, seed);
  std::vector<double> angles(trials, -1);
  tbb::parallel_for(std::uint64_t{0}, trials, [&](std::uint64_t i) {
    const Vector3 point = band.point(every * i + first);
    const ClosestPoint closest = caster.closest(point);
    if (std::abs(closest.distance) < min_tolerances * view.tolerance) return;
    if (!uncontested(caster, point, closest, view.tolerance)) return;
    const Answer answer = query_point(view, point);
    if (answer.status != Status::exact) return;
    angles[i] = std::acos(std::clamp(answer.normal.dot(closest.direction), -1.0, 1.0));
  });
  std::erase_if(angles, [](double angle) { return angle < 0; });
  if (angles.empty()) return 0;
  const auto middle = angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 2);
  std::nth_element(angles.begin(), middle, angles.end());
  return *middle;
}

}  // namespace spm::baker
