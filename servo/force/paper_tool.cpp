// SPDX-License-Identifier: Apache-2.0
#include "servo/force/paper_tool.hpp"

#include "common/base/rigid_pose.hpp"
#include "common/surface/support_plane_mapping.hpp"
#include "servo/force/pressed_part.hpp"

namespace spm {

namespace {

Vector3 middle_of(const AssetView& asset) noexcept {
  const Extent extent = extent_of(asset);
  return extent.low + extent.size / 2;
}

}  // namespace

PenetrationVolume paper_overlap(const AssetView& object1, const AssetView& object2,
                                const Eigen::Isometry3d& pose2) noexcept {
  if (!object1.maps_every_plane() || !object2.maps_every_plane() || !keeps_lengths(pose2)) {
    return {};
  }
  const Vector3 line = pose2 * middle_of(object2) - middle_of(object1);
  const std::size_t plane1 = support_plane_mapping(object1.planes, line);
  const std::size_t plane2 =
      support_plane_mapping(object2.planes, pose2.linear().transpose() * -line);
  return penetration_volume(object1, plane1, object2, plane2, pose2, 1, AreaFactor::paper);
}

double paper_tool_area(const AssetView& tool) noexcept {
  const Vector3 size = (extent_of(tool).size.array() - 2 * tool.band.margin).max(0);
  return pressed_part * 2 * (size.x() * size.y() + size.y() * size.z() + size.z() * size.x());
}

}  // namespace spm
