// SPDX-License-Identifier: Apache-2.0
#include "servo/app/pose_interpolator.hpp"

#include <algorithm>
#include <cmath>

namespace spm::servo {

namespace {

/// The weight of a new measurement in the known period.
constexpr double weight = 0.125;
/// A measurement counts as at most this many known periods.
constexpr double max_growth = 2;

double seconds_between(std::int64_t from_ns, std::int64_t to_ns) noexcept {
  return static_cast<double>(to_ns - from_ns) * 1e-9;
}

/// Axis times angle, rad, of the shorter rotation from one orientation to another; world frame.
Vector3 turn_between(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) noexcept {
  const Eigen::Quaterniond turn = to * from.conjugate();
  const double sine = turn.vec().norm();
  if (sine == 0) return Vector3::Zero();
  const double angle = 2 * std::atan2(sine, std::abs(turn.w()));
  return turn.vec() * (std::copysign(angle, turn.w()) / sine);
}

/// An orientation rotated by axis times angle.
Eigen::Quaterniond turned(const Eigen::Quaterniond& from, const Vector3& turn) noexcept {
  const double angle = turn.norm();
  if (angle == 0) return from;
  const Eigen::Quaterniond by(Eigen::AngleAxisd(angle, turn / angle));
  return (by * from).normalized();
}

}  // namespace

PoseInterpolator::PoseInterpolator(const PoseInterpolatorSettings& settings,
                                   const Placement& start) noexcept
    : settings_(settings), from_(start), to_(start), period_(settings.first_period) {}

void PoseInterpolator::give(const Placement& pose, double period, std::int64_t now_ns) noexcept {
  from_ = at(now_ns).pose;
  goes_on_ = goes_on_to(pose, now_ns);
  to_.position = pose.position;
  to_.rotation = pose.rotation;
  begin_from_here(now_ns);
  measure(period, now_ns);
  duration_ = std::max(stretch * period_, least_duration());
}

/// Whether a pose goes on from the one before.
bool PoseInterpolator::goes_on_to(const Placement& pose, std::int64_t now_ns) const noexcept {
  const double since = std::max(shortest_period, seconds_between(given_ns_, now_ns));
  if (!driven_ || since > longest_period) return false;
  return (pose.position - to_.position).norm() > still_speed * since ||
         turn_between(to_.rotation, pose.rotation).norm() > still_turn * since;
}

void PoseInterpolator::set_reach(double reach, std::int64_t now_ns) noexcept {
  if (reach == reach_) return;
  reach_ = reach;
  const double left = duration_ - seconds_between(begun_ns_, now_ns);
  if (!driven_ || left <= 0) return;
  from_ = at(now_ns).pose;
  begin_from_here(now_ns);
  duration_ = std::max(left, least_duration());
}

void PoseInterpolator::begin_from_here(std::int64_t now_ns) noexcept {
  begun_ns_ = now_ns;
  turn_ = turn_between(from_.rotation, to_.rotation);
}

/// The time in which the motion to the newest pose keeps to the caps, s. While the object turns, a
/// place at its reach moves by that much farther than the origin does.
double PoseInterpolator::least_duration() const noexcept {
  const double turn = turn_.norm();
  const double way = (to_.position - from_.position).norm() + reach_ * turn;
  return std::max(way / settings_.max_speed, turn / settings_.max_turn);
}

/// Updates the time between poses from the newest one.
void PoseInterpolator::measure(double period, std::int64_t now_ns) noexcept {
  const double since = seconds_between(given_ns_, now_ns);
  const bool plausible = driven_ && since >= shortest_period && since <= longest_period;
  if (plausible) {
    // A single frame that took long says little about the next ones.
    const double counted = std::min(since, max_growth * period_);
    period_ = measured_ ? period_ + weight * (counted - period_) : since;
    measured_ = true;
  } else if (!measured_ && period > 0) {
    period_ = std::clamp(period, shortest_period, longest_period);
  }
  // The same frame sent twice does not begin a new period.
  if (!driven_ || since >= shortest_period) given_ns_ = now_ns;
  driven_ = true;
}

InterpolatedPose PoseInterpolator::at(std::int64_t now_ns) const noexcept {
  InterpolatedPose now;
  now.driven = driven_;
  now.silent = driven_ ? std::max(0.0, seconds_between(given_ns_, now_ns)) : 0;
  const double since = seconds_between(begun_ns_, now_ns);
  if (!driven_ || since >= duration_) {
    now.pose = to_;
    return now;
  }
  const double share = std::max(0.0, since) / duration_;
  now.pose = from_;
  now.pose.position += share * (to_.position - from_.position);
  now.pose.rotation = turned(from_.rotation, share * turn_);
  now.velocity = (to_.position - from_.position) / duration_;
  now.angular_velocity = turn_ / duration_;
  return now;
}

}  // namespace spm::servo
