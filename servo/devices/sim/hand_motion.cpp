// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/hand_motion.hpp"

#include <algorithm>
#include <utility>

namespace spm::servo {

HandMotion HandMotion::back_and_forth(std::vector<Vector3> points, std::size_t turn, double speed,
                                      double period) {
  HandMotion motion;
  motion.kind_ = Kind::back_and_forth;
  motion.points_ = std::move(points);
  motion.turn_ = turn;
  motion.step_ = std::min(speed, fastest_target) * period;
  motion.period_ = period;
  motion.position_ = motion.points_.front();
  return motion;
}

HandMotion HandMotion::press(const Vector3& from, const Vector3& to, double speed, double period) {
  HandMotion motion = back_and_forth({from, to}, 1, speed, period);
  motion.kind_ = Kind::press;
  return motion;
}

HandMotion HandMotion::recorded(std::vector<Vector3> positions, double period) {
  HandMotion motion = back_and_forth(std::move(positions), 0, fastest_target, period);
  motion.kind_ = Kind::recorded;
  return motion;
}

std::size_t HandMotion::cycle_ticks() const noexcept {
  if (kind_ == Kind::recorded) return points_.size();
  double length = 0;
  for (std::size_t i = 1; i < points_.size(); ++i) length += (points_[i] - points_[i - 1]).norm();
  return step_ > 0 ? static_cast<std::size_t>(2 * length / step_) + 1 : 1;
}

HandTarget HandMotion::next() noexcept {
  const Vector3 before = position_;
  position_ = kind_ == Kind::recorded ? follow() : travel();
  return {position_, (position_ - before) / period_};
}

bool HandMotion::turn_around() noexcept {
  const std::size_t last = points_.size() - 1;
  if (forward_ ? heading_to_ < last : heading_to_ > turn_) {
    forward_ ? ++heading_to_ : --heading_to_;
    return true;
  }
  if (kind_ == Kind::press || last == turn_) return false;
  forward_ = !forward_;
  forward_ ? ++heading_to_ : --heading_to_;
  return true;
}

Vector3 HandMotion::travel() noexcept {
  Vector3 at = position_;
  double left = step_;
  // Points that coincide have no distance; the bound keeps a tick finite.
  for (std::size_t passed = 0; passed <= 2 * points_.size(); ++passed) {
    const Vector3 way = points_[heading_to_] - at;
    const double length = way.norm();
    if (length > left) return at + way * (left / length);
    at = points_[heading_to_];
    left -= length;
    if (!turn_around()) break;
  }
  return at;
}

Vector3 HandMotion::follow() noexcept {
  const Vector3 way = points_[heading_to_] - position_;
  if (heading_to_ + 1 < points_.size()) ++heading_to_;
  const double length = way.norm();
  return length > step_ ? Vector3(position_ + way * (step_ / length)) : Vector3(position_ + way);
}

}  // namespace spm::servo
