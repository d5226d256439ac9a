// SPDX-License-Identifier: Apache-2.0
#include "common/culling/support_culling.hpp"

#include <algorithm>

#include "common/base/spread_direction.hpp"
#include "common/culling/hull_distance.hpp"
#include "common/surface/support_plane_mapping.hpp"

namespace spm {

namespace {

/// The hull is chosen from the finest level of no more samples than this.
constexpr std::uint32_t most_samples = 1U << 15U;
constexpr std::size_t first_directions = 64;
constexpr double tolerance_share = 0.01;
constexpr int max_hull_steps = 64;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Distance from a point to the hull of others, or a bound that is `enough`.
double outside(const std::vector<Vector3>& hull, const Vector3& point, double enough) noexcept {
  const auto support = [&](const Vector3& v) {
    return Vector3(hull[support_mapping(hull, v)] - point);
  };
  return hull_distance(support, hull.front() - point, enough, max_hull_steps).lower_bound;
}

/// How far above a plane of the object the surface is at the least, m.
double gap(const SupportedObject& object, std::uint32_t which, const SupportHull& surface,
           const Eigen::Isometry3d& to_object) noexcept {
  const SupportPlane& plane = object.planes[which];
  return surface.lowest(to_object.linear().transpose() * plane.n) +
         plane.n.dot(to_object.translation() - object.scale * plane.x0);
}

}  // namespace

double SupportHull::lowest(const Vector3& normal) const noexcept {
  double least = points.empty() ? -infinity : infinity;
  for (const Vector3& point : points) least = std::min(least, normal.dot(point));
  return least - grown;
}

SupportHull support_hull(const SurfaceSamples& surface) {
  SupportHull hull;
  hull.centre = surface.centre;
  if (surface.levels.empty()) return hull;
  const SampleLevel* level = &surface.levels.front();
  for (const SampleLevel& finer : surface.levels) {
    if (finer.count <= most_samples) level = &finer;
  }
  std::vector<Vector3> places;
  places.reserve(level->count);
  double beside = 0;  // what the samples of a coarse level stand for lies in their spheres
  for (std::uint32_t i = level->first; i < level->first + level->count; ++i) {
    const SamplePlace& place = surface.places[i];
    places.emplace_back(place.position[0], place.position[1], place.position[2]);
    if (level != &surface.levels.back()) beside = std::max(beside, double{place.radius});
  }
  hull.points.reserve(first_directions);
  for (std::size_t k = 0; k < first_directions; ++k) {
    const Vector3& extreme = places[support_mapping(places, spread_direction(k, first_directions))];
    const auto end = hull.points.end();
    if (std::find(hull.points.begin(), end, extreme) == end) hull.points.push_back(extreme);
  }
  const double bound = surface.levels.back().bound, tolerance = tolerance_share * surface.radius;
  for (const Vector3& place : places) {
    if (outside(hull.points, place, tolerance) > tolerance) hull.points.push_back(place);
  }
  hull.grown = tolerance + beside + bound;
  hull.radius = surface.radius + bound;
  return hull;
}

CullStage objects_apart(const SupportedObject& object, const SupportHull& surface,
                        const Eigen::Isometry3d& to_object, double reach,
                        std::uint32_t& last) noexcept {
  const Vector3 centre = to_object * surface.centre;
  const Vector3 low = object.scale * object.low, high = object.scale * object.high;
  const Vector3 outside = centre - centre.cwiseMax(low).cwiseMin(high);
  if (outside.norm() > reach + surface.radius) return CullStage::box;
  if (object.planes.empty()) return CullStage::none;
  if (last < object.planes.size() && gap(object, last, surface, to_object) > reach) {
    return CullStage::remembered;
  }
  const Vector3 way = outside.isZero() ? Vector3(centre - (low + high) / 2) : outside;
  const auto most_parallel = static_cast<std::uint32_t>(support_plane_mapping(object.planes, way));
  if (!(gap(object, most_parallel, surface, to_object) > reach)) return CullStage::none;
  last = most_parallel;
  return CullStage::plane;
}

}  // namespace spm
