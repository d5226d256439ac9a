// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/falcon/falcon_tracker.hpp"

#include <algorithm>
#include <utility>

#include "servo/devices/base/lost_home.hpp"

namespace spm::servo {

DeviceHealth FalconTracker::follow(const FalconReport& report, std::int64_t came_ns) noexcept {
  if (report.homed != falcon_all_homed) {
    // Homing sets the counts to their right values, so the previous position is no longer valid.
    followed_ = lost_home_ = false;
    return DeviceHealth::not_homed;
  }
  if (lost_home_) return DeviceHealth::not_homed;
  if (frozen(report, came_ns)) return DeviceHealth::fault;

  const Vector3 angles = falcon_angles(report.encoders, home_angle_);
  FalconPose pose = falcon_forward(angles, followed_ ? position_ : Vector3::Zero());
  if (followed_ && pose.search != FalconSearch::found) {
    pose = falcon_forward(angles, Vector3::Zero());
  }
  if (pose.search != FalconSearch::found || pose.position.cwiseAbs().maxCoeff() > falcon_farthest) {
    return DeviceHealth::fault;
  }
  const double seconds = static_cast<double>(came_ns - position_ns_) * 1e-9;
  const double farthest = falcon_fastest_hand * (std::max(seconds, 0.0) + falcon_report_delay);
  // The last position gets older meanwhile, so that a true position is accepted again soon.
  const double way = followed_ ? (pose.position - position_).norm() : 0;
  if (way > farthest) {
    lost_home_ = way > lost_home_jump;
    return DeviceHealth::fault;
  }

  position_ = pose.position;
  angles_ = angles;
  position_ns_ = came_ns;
  followed_ = true;
  return DeviceHealth::ok;
}

bool FalconTracker::frozen(const FalconReport& report, std::int64_t came_ns) noexcept {
  const bool moved = !followed_ || report.encoders != counts_;
  const bool gap = came_ns - std::exchange(last_ns_, came_ns) >
                   std::chrono::nanoseconds(falcon_longest_gap).count();
  counts_ = report.encoders;
  if (moved) stuck_ = false;
  if (moved || (!stuck_ && (gap || pushed_ < falcon_frozen_force))) moved_ns_ = came_ns;
  // They count as stuck until one changes, because from now on the force is zero.
  stuck_ = stuck_ || came_ns - moved_ns_ > std::chrono::nanoseconds(falcon_frozen_time).count();
  return stuck_;
}

}  // namespace spm::servo
