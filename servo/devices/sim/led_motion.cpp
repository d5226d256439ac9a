// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/led_motion.hpp"

#include <algorithm>
#include <cmath>

#include "servo/devices/sim/pose_motion.hpp"

namespace spm::servo {

namespace {

/// Of each follower, s: half the time between two frames of a screen, so that both together bridge
/// it and add less than one to what a person sees.
constexpr double follow_time = 8e-3;

/// A part of the way from one pose to another, of at most `way` m and `turn` rad.
HandPose towards(const HandPose& from, const HandPose& to, double share, double way,
                 double turn) noexcept {
  HandPose pose = from;
  Vector3 step = share * (to.position - from.position);
  if (const double length = step.norm(); length > way) step *= way / length;
  pose.position += step;
  const double angle = from.orientation.angularDistance(to.orientation);
  if (angle > 0) {
    const double part = std::min(share, turn / angle);
    pose.orientation = from.orientation.slerp(part, to.orientation).normalized();
  }
  return pose;
}

}  // namespace

LedMotion::LedMotion(const HandPose& start, double period) noexcept
    : period_(period), share_(1 - std::exp(-period / follow_time)), ahead_(start), pose_(start) {}

SixdofTarget LedMotion::next(const HandPose& wanted) noexcept {
  const bool finite = wanted.position.allFinite() && wanted.orientation.coeffs().allFinite();
  const HandPose goal = finite ? wanted : ahead_;
  const HandPose before = pose_;
  ahead_ = towards(ahead_, goal, share_, fastest_target * period_, fastest_turn * period_);
  pose_ = towards(pose_, ahead_, share_, fastest_target * period_, fastest_turn * period_);
  SixdofTarget target;
  target.position = pose_.position;
  target.orientation = pose_.orientation;
  target.velocity = (pose_.position - before.position) / period_;
  Eigen::Quaterniond turned = pose_.orientation * before.orientation.conjugate();
  if (turned.w() < 0) turned.coeffs() *= -1;
  const Eigen::AngleAxisd turn(turned);
  target.angular_velocity = turn.angle() / period_ * turn.axis();
  return target;
}

}  // namespace spm::servo
