// SPDX-License-Identifier: Apache-2.0
#include "common/culling/support_culling.hpp"

#include <algorithm>
#include <array>

#include "common/base/rigid_pose.hpp"
#include "common/base/spread_direction.hpp"
#include "common/culling/hull_distance.hpp"
#include "common/surface/support_plane_mapping.hpp"

namespace spm {

namespace {

constexpr int max_hull_steps = 64;

Vector3 to_vector(const std::array<float, 3>& v) noexcept { return {v[0], v[1], v[2]}; }

/// Distance from a point to the hull of others.
double outside(const std::vector<Vector3>& hull, const Vector3& point, double enough) noexcept {
  const auto support = [&](const Vector3& v) {
    return Vector3(hull[support_mapping(hull, v)] - point);
  };
  return hull_distance(support, hull.front() - point, enough, max_hull_steps).lower_bound;
}

/// Adds every sample that lies farther than the tolerance outside the hull of those added before
/// it.
void take_all_in(std::vector<Vector3>& hull, const std::vector<Vector3>& samples,
                 double tolerance) {
  for (const Vector3& sample : samples) {
    if (outside(hull, sample, tolerance) > tolerance) hull.push_back(sample);
  }
}

/// Their distance along a direction of the first object's frame; above 0 they are separated.
double gap(const SupportHull& object1, const SupportHull& object2, const Eigen::Isometry3d& pose2,
           const Vector3& direction) noexcept {
  const Vector3 back = pose2.linear().transpose() * -direction;
  const Vector3 point2 = pose2 * object2.points[support_mapping(object2.points, back)];
  const Vector3& point1 = object1.points[support_mapping(object1.points, direction)];
  return direction.dot(point2 - point1) - object1.grown - object2.grown;
}

}  // namespace

SupportHull support_hull(const SurfaceSamples& samples, double tolerance, std::size_t planes) {
  SupportHull made;
  std::vector<Vector3> places;
  const SampleLevel& finest = samples.levels.back();
  for (std::uint32_t i = finest.first; i < finest.first + finest.count; ++i) {
    places.push_back(to_vector(samples.places[i].position));
  }
  const std::size_t directions = std::max<std::size_t>(planes, 4);
  std::vector<Vector3> normals;
  normals.reserve(directions);
  for (std::size_t k = 0; k < directions; ++k) normals.push_back(spread_direction(k, directions));
  std::vector<std::size_t> extremes;
  extremes.reserve(normals.size());
  for (const Vector3& normal : normals) extremes.push_back(support_mapping(places, normal));
  std::sort(extremes.begin(), extremes.end());
  extremes.erase(std::unique(extremes.begin(), extremes.end()), extremes.end());
  for (const std::size_t which : extremes) made.points.push_back(places[which]);
  take_all_in(made.points, places, tolerance);
  // The surface extends beyond its samples by no more than the samples' own bound.
  made.grown = tolerance + finest.bound;
  for (const Vector3& normal : normals) {
    made.planes.push_back(vertex_support_plane(made.points, normal));
    made.planes.back().x0 += made.grown * normal;
  }
  made.centre = samples.centre;
  made.radius = samples.radius + finest.bound;
  return made;
}

CullResult objects_apart(const SupportHull& object1, const SupportHull& object2,
                         const Eigen::Isometry3d& pose2, SeparatingDirection& last) noexcept {
  if (object1.points.empty() || object2.points.empty() || !keeps_lengths(pose2)) return {};
  const Vector3 line = pose2 * object2.centre - object1.centre;
  const double apart = line.norm() - object1.radius - object2.radius;
  if (apart > 0) return {true, CullStage::ball, apart};
  if (!last.direction.isZero()) {
    const double clear = gap(object1, object2, pose2, last.direction);
    if (clear > 0) return {true, CullStage::remembered, clear};
  }
  if (!object1.planes.empty()) {
    const SupportPlane& plane = object1.planes[support_plane_mapping(object1.planes, line)];
    const Vector3 back = pose2.linear().transpose() * -plane.n;
    const Vector3 point = pose2 * object2.points[support_mapping(object2.points, back)];
    const double clear = -support_plane_depth(plane, point) - object2.grown;
    if (clear > 0) {
      last.direction = plane.n;
      return {true, CullStage::plane, clear};
    }
  }
  // Where they are apart, the set of all differences of their points does not contain the origin.
  const auto support = [&](const Vector3& v) {
    const Vector3 back = pose2.linear().transpose() * v;
    return Vector3(pose2 * object2.points[support_mapping(object2.points, back)] -
                   object1.points[support_mapping(object1.points, -v)]);
  };
  const double grown = object1.grown + object2.grown;
  const HullDistance found = hull_distance(support, last.direction.isZero() ? line : last.direction,
                                           grown, max_cull_steps);
  if (!(found.lower_bound > grown)) return {};
  last.direction = found.direction;
  return {true, CullStage::search, found.lower_bound - grown};
}

}  // namespace spm
