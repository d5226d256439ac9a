// SPDX-License-Identifier: Apache-2.0
#include "servo/force/tool_culling.hpp"

#include <algorithm>
#include <limits>

#include "common/surface/support_plane.hpp"

namespace spm {

namespace {

/// Spheres that stand for the tool, at most.
constexpr std::uint32_t most_spheres = 128;
constexpr double doubtful_tolerances = 2;

}  // namespace

ToolCulling::ToolCulling(const SurfaceSamples& tool, std::size_t objects)
    : tool_(&tool), last_(objects, std::numeric_limits<std::uint32_t>::max()) {
  if (tool.levels.empty()) return;
  level_ = tool.levels.front();
  for (const SampleLevel& level : tool.levels) {
    if (level.count <= most_spheres) level_ = level;
  }
  grown_ = tool.levels.back().bound;
}

/// How far above a support plane of an object the tool is, m.
double ToolCulling::gap(const SupportPlane& plane, double scale,
                        const Eigen::Isometry3d& to_object) const noexcept {
  const Vector3 normal = to_object.linear().transpose() * plane.n;
  double lowest = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = level_.first; i < level_.first + level_.count; ++i) {
    const SamplePlace& place = tool_->places[i];
    const double height = normal.x() * double{place.position[0]} +
                          normal.y() * double{place.position[1]} +
                          normal.z() * double{place.position[2]} - double{place.radius};
    lowest = std::min(lowest, height);
  }
  return lowest + plane.n.dot(to_object.translation()) - scale * plane.n.dot(plane.x0) - grown_;
}

bool ToolCulling::apart(std::size_t number, const ContactObject& object,
                        const Eigen::Isometry3d& pose, double reach) noexcept {
  const AssetView& field = *object.field;
  const Eigen::Isometry3d to_object = object.pose.inverse(Eigen::Isometry) * pose;
  const double lift = object.texture.amplitude > 0 ? object.texture.amplitude : 0;
  const double far = reach + lift + doubtful_tolerances * object.scale * field.tolerance;
  const Extent extent = extent_of(field);
  const Vector3 centre = to_object * tool_->centre;
  const Vector3 low = object.scale * extent.low, high = low + object.scale * extent.size;
  const Vector3 outside = (low - centre).cwiseMax(centre - high).cwiseMax(0);
  if (outside.norm() > far + tool_->radius + grown_) return true;
  if (field.planes.empty() || level_.count == 0) return false;
  std::uint32_t& last = last_[number];
  if (last < field.planes.size() && gap(field.planes[last], object.scale, to_object) > far) {
    return true;
  }
  // The plane that the tool's middle is farthest outside of: of all, it separates a ball best.
  double best = -std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < field.planes.size(); ++i) {
    const SupportPlane& plane = field.planes[i];
    const double outside_by = plane.n.dot(centre - object.scale * plane.x0);
    if (!(outside_by > best)) continue;
    best = outside_by;
    last = i;
  }
  if (!(best > far)) return false;
  return gap(field.planes[last], object.scale, to_object) > far;
}

}  // namespace spm
