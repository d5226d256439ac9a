// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/hand_pose.hpp"
#include "servo/devices/sim/sixdof_plant.hpp"

namespace spm::servo {

/// Where a hand that an application leads wants its tool, tick by tick. It goes to what it was told
/// as a critically damped follower does, no faster than a target may move and turn, so that rare
/// or distant commands give an even motion and never a jump. While nobody leads it, it is slack: it
/// goes where the tool is, so that the grip lets go of it within a tenth of a second.
class LedMotion {
 public:
  LedMotion() = default;
  /// `period` of a tick, s, above 0.
  LedMotion(const HandPose& start, double period) noexcept;

  /// The target of the next tick, while nobody leads the hand and its tool is here, or while it is
  /// led to `wanted`. Poses that are not finite are not followed.
  [[nodiscard]] SixdofTarget next(const HandPose& wanted) noexcept;
  [[nodiscard]] const HandPose& pose() const noexcept { return pose_; }

 private:
  double period_ = 1e-3;
  double share_ = 1;       ///< of the way, that each of two equal followers goes in a tick
  HandPose ahead_, pose_;  ///< the first follower, and the second behind it
};

}  // namespace spm::servo
