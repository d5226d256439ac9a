// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/pose_motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace spm::servo {

namespace {

/// The pose that is a share, 0 to 1, of the way from one to another.
HandPose between(const HandPose& from, const HandPose& to, double share) {
  const Vector3 turn = share * turn_between(from.orientation, to.orientation);
  return {from.position + share * (to.position - from.position),
          (orientation_of(turn) * from.orientation).normalized()};
}

}  // namespace

PoseMotion PoseMotion::along(Kind kind, std::vector<HandPose> poses, std::size_t turn,
                             const PoseSpeed& speed, double period) {
  PoseMotion motion;
  motion.kind_ = kind;
  motion.poses_ = std::move(poses);
  motion.turn_ = turn;
  motion.step_ = {std::min(speed.moving, fastest_target) * period,
                  std::min(speed.turning, fastest_turn) * period};
  motion.period_ = period;
  motion.pose_ = motion.poses_.front();
  return motion;
}

PoseMotion PoseMotion::back_and_forth(std::vector<HandPose> poses, std::size_t turn,
                                      const PoseSpeed& speed, double period) {
  return along(Kind::back_and_forth, std::move(poses), turn, speed, period);
}

PoseMotion PoseMotion::press(std::vector<HandPose> poses, const PoseSpeed& speed, double period) {
  return along(Kind::press, std::move(poses), 0, speed, period);
}

PoseMotion PoseMotion::recorded(std::vector<HandPose> poses, double period) {
  return along(Kind::recorded, std::move(poses), 0, {fastest_target, fastest_turn}, period);
}

double PoseMotion::ticks_between(const HandPose& from, const HandPose& to) const noexcept {
  return std::max((to.position - from.position).norm() / step_.moving,
                  turn_between(from.orientation, to.orientation).norm() / step_.turning);
}

std::size_t PoseMotion::cycle_ticks() const noexcept {
  if (kind_ == Kind::recorded) return poses_.size();
  double ticks = 0;
  for (std::size_t i = 1; i < poses_.size(); ++i) ticks += ticks_between(poses_[i - 1], poses_[i]);
  return static_cast<std::size_t>(2 * ticks) + 1;
}

SixdofTarget PoseMotion::next() noexcept {
  const HandPose before = pose_;
  if (kind_ == Kind::recorded) {
    const HandPose& to = poses_[heading_to_];
    if (heading_to_ + 1 < poses_.size()) ++heading_to_;
    pose_ = between(pose_, to, 1 / std::max(1.0, ticks_between(pose_, to)));
  } else {
    pose_ = travel();
  }
  SixdofTarget target;
  target.position = pose_.position;
  target.orientation = pose_.orientation;
  target.velocity = (pose_.position - before.position) / period_;
  target.angular_velocity = turn_between(before.orientation, pose_.orientation) / period_;
  return target;
}

bool PoseMotion::turn_around() noexcept {
  const std::size_t last = poses_.size() - 1;
  if (forward_ ? heading_to_ < last : heading_to_ > turn_) {
    forward_ ? ++heading_to_ : --heading_to_;
    return true;
  }
  if (kind_ == Kind::press || last == turn_) return false;
  forward_ = !forward_;
  forward_ ? ++heading_to_ : --heading_to_;
  return true;
}

HandPose PoseMotion::travel() noexcept {
  HandPose at = pose_;
  double left = 1;  // ticks
  // Poses that coincide have no distance; the bound keeps a tick finite.
  for (std::size_t passed = 0; passed <= 2 * poses_.size(); ++passed) {
    const double ticks = ticks_between(at, poses_[heading_to_]);
    if (ticks > left) return between(at, poses_[heading_to_], left / ticks);
    at = poses_[heading_to_];
    left -= ticks;
    if (!turn_around()) break;
  }
  return at;
}

}  // namespace spm::servo
