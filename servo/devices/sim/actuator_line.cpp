// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/actuator_line.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace spm::servo {

namespace {

/// Time constant of a bandwidth, s; 0 where there is no lag.
double lag_of(double bandwidth) noexcept {
  return bandwidth > 0 && std::isfinite(bandwidth) ? 1 / (2 * std::numbers::pi * bandwidth) : 0;
}

Vector3 capped(const Vector3& force, double cap) noexcept {
  const double size = force.norm();
  return size > cap ? Vector3(force * (cap / size)) : force;
}

}  // namespace

ActuatorLine::ActuatorLine(const ActuatorSettings& settings) noexcept
    : settings_(settings),
      lag_(lag_of(settings.bandwidth) / settings.period),
      random_(settings.seed) {
  settings_.delay_ticks = std::clamp(settings.delay_ticks, 0.0, longest_delay);
}

void ActuatorLine::reset() noexcept {
  first_ = count_ = 0;
  last_due_ = 0;
  held_.setZero();
  actuator_.setZero();
}

void ActuatorLine::arrive() noexcept {
  held_ = pending_[first_].force;
  first_ = (first_ + 1) % pending_.size();
  --count_;
}

void ActuatorLine::command(const Vector3& force) noexcept {
  for (std::size_t i = 0; i < count_; ++i) pending_[(first_ + i) % pending_.size()].due -= 1;
  last_due_ -= 1;
  // Both are drawn in every tick, so that one setting does not change the other's random numbers.
  const double share = random_.between(0, 1);
  const double deviation = settings_.jitter > 0 ? random_.normal() * settings_.jitter : 0;
  if (share < settings_.lost_share) return;
  double due = std::max(0.0, settings_.delay_ticks + deviation / settings_.period);
  due = std::max(due, last_due_);  // a bus keeps the order
  last_due_ = due;
  if (count_ == pending_.size()) arrive();
  pending_[(first_ + count_) % pending_.size()] = {due, capped(force, settings_.force_cap)};
  ++count_;
}

Vector3 ActuatorLine::drive(double ticks) noexcept {
  if (!(lag_ > 0)) {
    actuator_ = held_;
    return held_ * ticks;
  }
  const double left = std::exp(-ticks / lag_);
  const Vector3 behind = actuator_ - held_;
  actuator_ = held_ + left * behind;
  return held_ * ticks + behind * (lag_ * (1 - left));
}

Vector3 ActuatorLine::mean_force(double from, double to) noexcept {
  Vector3 sum = Vector3::Zero();
  double now = from;
  while (count_ > 0 && pending_[first_].due < to) {
    const double due = std::max(now, pending_[first_].due);
    if (due > now) sum += drive(due - now);
    now = due;
    arrive();
  }
  sum += drive(to - now);
  return sum / (to - from);
}

}  // namespace spm::servo
