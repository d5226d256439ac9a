// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/wooden/wooden_tracker.hpp"

#include <algorithm>
#include <cmath>

#include "servo/devices/base/lost_home.hpp"
#include "servo/devices/wooden/kept_signs.hpp"

namespace spm::servo {

namespace {

/// A force limited to a cap, with its direction kept. Zero if it is not finite.
Vector3 capped(const Vector3& force, double cap) noexcept {
  if (!force.allFinite()) return Vector3::Zero();
  const double size = force.norm();
  if (!(size > cap)) return force;
  return force * (cap / size);
}

}  // namespace

void WoodenTracker::take(const WoodenReport& report, std::int64_t came_ns) noexcept {
  if (connections_ == 0 || report.connection != last_.connection) {
    begin(report);
  } else {
    follow_button(report);
  }
  measure(report, came_ns);
  last_ = report;
  came_ns_ = came_ns;
}

void WoodenTracker::begin(const WoodenReport& report) noexcept {
  ++connections_;
  calibration_ = wooden_calibration(options_, report.protocol);
  if (report.signs != WoodenSigns{}) take_signs(report.signs, calibration_);
  forget_counts();
  set_sent_ = false;
  const WoodenHome word = options_.home_confirmed;
  if (word == WoodenHome::always || (word == WoodenHome::once && connections_ == 1)) {
    homing_ = Homing::done;
  } else {
    homing_ = report.calibration_pressed ? Homing::clearing : Homing::wanted;
  }
}

void WoodenTracker::follow_button(const WoodenReport& report) noexcept {
  switch (homing_) {
    case Homing::clearing:
      if (report.calibration_pressed) return;
      homing_ = Homing::wanted;
      forget_counts();
      break;
    case Homing::setting:
      if (report.calibration_pressed) return;
      homing_ = Homing::done;
      forget_counts();
      break;
    case Homing::wanted:
    case Homing::done:
      if (!report.calibration_pressed || last_.calibration_pressed) return;
      homing_ = Homing::setting;
      break;
  }
  set_sent_ = false;
}

void WoodenTracker::measure(const WoodenReport& report, std::int64_t came_ns) noexcept {
  std::array<std::int64_t, 3> counts{};
  for (std::size_t i = 0; i < counts.size(); ++i) {
    counts[i] = unwrap_[i].next(report.counters[i]);
  }
  const WoodenHandle handle = wooden_handle(report.counters[3]);
  angles_ = wooden_angles(*options_.model, calibration_, counts);
  const Vector3 before = state_.position;
  state_.position = wooden_to_world * wooden_position(*options_.model, angles_);
  // The handle at rest is the tool without rotation, in either frame.
  const Eigen::Quaterniond frame(wooden_to_world);
  const Eigen::Quaterniond turned =
      wooden_orientation(*options_.model, calibration_, angles_,
                         {handle.counter, report.counters[4], report.counters[5]});
  state_.orientation = (frame * turned * frame.conjugate()).normalized();
  state_.buttons = handle.pressed ? 1 : 0;

  plausible_ = state_.position.allFinite();
  if (position_known_ && plausible_) {
    const double interval =
        std::max(static_cast<double>(came_ns - came_ns_) * 1e-9, wooden_min_interval);
    const double way = (state_.position - before).norm();
    plausible_ = way <= wooden_fastest * interval;
    if (!plausible_ && way > lost_home_jump && homing_ == Homing::done) homing_ = Homing::wanted;
  }
  position_known_ = state_.position.allFinite();
}

void WoodenTracker::forget_counts() noexcept {
  for (EncoderUnwrap& unwrap : unwrap_) unwrap.reset();
  position_known_ = false;
}

DeviceHealth WoodenTracker::health(std::int64_t at_ns) const noexcept {
  if (connections_ == 0 || at_ns - came_ns_ > wooden_silent_ns) return DeviceHealth::silent;
  if (!plausible_) return DeviceHealth::fault;
  if (homing_ != Homing::done) return DeviceHealth::not_homed;
  if (!last_.signs_confirmed && !options_.count_signs) return DeviceHealth::unconfirmed;
  return DeviceHealth::ok;
}

bool WoodenTracker::command(const Wrench& wrench, std::int64_t at_ns,
                            WoodenCommand& command) noexcept {
  warm_up_to(at_ns);
  command = WoodenCommand{};
  const bool is_new = decide(wrench, at_ns, command);
  if (is_new) flowing_ = command.currents;
  return is_new;
}

/// Counts the currents that flowed since the last call.
void WoodenTracker::warm_up_to(std::int64_t at_ns) noexcept {
  const double seconds = warm_ns_ > 0 ? static_cast<double>(at_ns - warm_ns_) * 1e-9 : 0;
  warm_ns_ = at_ns;
  for (std::size_t i = 0; i < heat_.size(); ++i) {
    heat_[i].add(options_.motor, flowing_[i] * 1e-3, std::max(0.0, seconds));
  }
}

/// All motors alike, so that the force keeps its direction.
void WoodenTracker::spare_motors(WoodenCommand& command) noexcept {
  double share = 1;
  for (const MotorHeat& heat : heat_) share = std::min(share, heat.share(options_.motor));
  if (share >= 1) return;
  ++limited_commands_;
  for (std::int16_t& current : command.currents) {
    current = static_cast<std::int16_t>(std::lround(share * current));
  }
}

double WoodenTracker::hottest() const noexcept {
  double hottest = options_.motor.ambient;
  for (const MotorHeat& heat : heat_) hottest = std::max(hottest, heat.hottest(options_.motor));
  return hottest;
}

bool WoodenTracker::decide(const Wrench& wrench, std::int64_t at_ns,
                           WoodenCommand& command) noexcept {
  if (homing_ == Homing::clearing || homing_ == Homing::setting) {
    // Sent again only if it was lost, because each one sets the counters, wherever the arm is by
    // then.
    if (set_sent_ && at_ns - set_ns_ <= wooden_silent_ns) return false;
    set_sent_ = true;
    set_ns_ = at_ns;
    command.request = WoodenRequest::set_counters;
    if (homing_ == Homing::clearing) {
      command.counters = last_.counters;
      command.counters[3] = wooden_handle(last_.counters[3]).counter;
    }
    return true;
  }
  if (health(at_ns) != DeviceHealth::ok) return true;
  const Vector3 force = wooden_to_world.transpose() * capped(wrench.force, options_.force_cap);
  Vector3 torques = wooden_torques(*options_.model, angles_, force);
  if (options_.gravity) torques += wooden_gravity_torques(*options_.model, angles_);
  command.currents =
      wooden_currents(*options_.model, calibration_, torques, options_.current_limit);
  spare_motors(command);
  return true;
}

}  // namespace spm::servo
