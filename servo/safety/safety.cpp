// SPDX-License-Identifier: Apache-2.0
#include "servo/safety/safety.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/turn_between.hpp"

namespace spm::servo {

namespace {

constexpr double fastest_hand = 1.0;  // m/s
constexpr double slew_margin = 2.0;
constexpr double min_slew = 1.0;  // N a tick, so that a soft asset is not limited by rounding
constexpr double ramp_seconds = 0.1;
// slow enough that a hand that leans on a surface can follow it
constexpr double fade_seconds = 0.5;

/// Limits how far a force or torque may grow or turn in a tick. Decrease is not limited: what ends
/// must end.
Vector3 limit_slew(const Vector3& previous, const Vector3& wanted, double limit) noexcept {
  const double before = previous.norm();
  const double after = wanted.norm();
  const Vector3 from = before > after ? Vector3(previous * (after / before)) : previous;
  const Vector3 step = wanted - from;
  const double size = step.norm();
  return size > limit ? Vector3(from + step * (limit / size)) : wanted;
}

/// Where the soft start, at that share of its way, goes from `from` to what is wanted. What ends
/// must end: of the old one never more is left than is wanted now.
Vector3 ramped(Vector3& from, const Vector3& wanted, double share) noexcept {
  const double size = wanted.norm();
  if (from.norm() > size) from *= size / from.norm();
  return (1 - share) * from + share * wanted;
}

/// Holds a size to a cap. Returns whether it had to.
bool cap_to(Vector3& vector, double cap) noexcept {
  const double size = vector.norm();
  if (!(size > cap)) return false;
  vector *= cap / size;
  return true;
}

}  // namespace

const char* to_string(ForceOff cause) noexcept {
  switch (cause) {
    case ForceOff::none:
      return "none";
    case ForceOff::starting:
      return "starting";
    case ForceOff::asset_lost:
      return "asset_lost";
    case ForceOff::not_a_number:
      return "not_a_number";
    case ForceOff::device_fault:
      return "device_fault";
    case ForceOff::stopping:
      return "stopping";
    case ForceOff::device_silent:
      return "device_silent";
    case ForceOff::device_gone:
      return "device_gone";
    case ForceOff::not_homed:
      return "not_homed";
    case ForceOff::jumped:
      return "jumped";
    case ForceOff::clutched:
      return "clutched";
    case ForceOff::outside_workspace:
      return "outside_workspace";
    case ForceOff::application_silent:
      return "application_silent";
    case ForceOff::stalled:
      return "stalled";
    case ForceOff::unacknowledged:
      return "unacknowledged";
    case ForceOff::not_enabled:
      return "not_enabled";
    case ForceOff::runaway:
      return "runaway";
    case ForceOff::unconfirmed:
      return "unconfirmed";
  }
  return "unknown";
}

const char* cure_of(ForceOff cause) noexcept {
  switch (cause) {
    case ForceOff::none:
    case ForceOff::stopping:
      return "nothing to do";
    case ForceOff::starting:
      return "wait until the asset is loaded";
    case ForceOff::asset_lost:
      return "bake the asset again or put the file back, the loop takes it up by itself";
    case ForceOff::not_a_number:
      return "check the device's calibration, then bake the asset again";
    case ForceOff::device_fault:
      return "check the device's cable and power, or the poses that an external device's process "
             "writes";
    case ForceOff::device_silent:
      return "check the device's cable, its power and the hub; the loop goes on when it answers";
    case ForceOff::device_gone:
      return "plug the device in again, the loop takes it up by itself";
    case ForceOff::not_homed:
      return "move the tool through its whole range once, as the device's page says";
    case ForceOff::jumped:
      return "check the device's encoders and its cable; the force fades in again by itself";
    case ForceOff::clutched:
      return "let the clutch go, the device's button or the application that holds it";
    case ForceOff::outside_workspace:
      return "bring the tool back towards its home, and home the device again if it is there";
    case ForceOff::application_silent:
      return "look after the application that moved objects, or end it; the force fades in again "
             "by "
             "itself";
    case ForceOff::stalled:
      return "give the loop real-time priority, which 'spm-servo doctor' explains; it goes on by "
             "itself";
    case ForceOff::unacknowledged:
      return "look whether all is well again, then press a button of the device, or acknowledge it "
             "by an application (spm_client_acknowledge)";
    case ForceOff::not_enabled:
      return "hold the device's enable switch, which --enable-switch names";
    case ForceOff::runaway:
      return "check the device's signs and wiring: it pushes the hand into what it touches; then "
             "press a button of the device, or acknowledge it by an application";
    case ForceOff::unconfirmed:
      return "see whether the tool follows each joint, then start with the device's signs= named, "
             "and keep_signs=on to confirm them for good";
  }
  return "";
}

bool is_outside(const Vector3& position, const Vector3& half_edges) noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    const double most = (1 + workspace_margin) * half_edges[axis];
    if (most > 0 && std::abs(position[axis]) > most) return true;
  }
  return false;
}

bool is_pose(const HandPose& pose) noexcept {
  return pose.position.allFinite() &&
         std::abs(pose.orientation.norm() - 1) <= orientation_slack;  // NaN is not
}

bool JumpGate::jumped(const HandPose& pose, std::uint64_t tick) noexcept {
  const double ticks = static_cast<double>(tick > last_tick_ ? tick - last_tick_ : 1);
  const bool is_too_far =
      is_known_ && ((pose.position - last_.position).norm() > max_a_tick_ * ticks ||
                    turn_between(last_.orientation, pose.orientation).norm() > max_turn_ * ticks);
  last_ = pose;
  last_tick_ = tick;
  is_known_ = true;
  return is_too_far;
}

double slew_limit(double stiffness, double rate_hz) noexcept {
  return std::max(min_slew, slew_margin * stiffness * fastest_hand / rate_hz);
}

double torque_slew_limit(double slew, double arm) noexcept {
  return slew * std::max(arm, shortest_arm);
}

SafetySettings safety_settings(double force_cap, double stiffness, double rate_hz,
                               double torque_cap) noexcept {
  SafetySettings settings;
  settings.force_cap = force_cap;
  settings.slew_limit = slew_limit(stiffness, rate_hz);
  settings.torque_cap = torque_cap;
  settings.torque_slew = torque_slew_limit(settings.slew_limit, 0);
  settings.ramp_ticks =
      std::max(1U, static_cast<std::uint32_t>(std::lround(ramp_seconds * rate_hz)));
  settings.fade_ticks =
      std::max(1U, static_cast<std::uint32_t>(std::lround(fade_seconds * rate_hz)));
  return settings;
}

void SafetyStage::restart() noexcept {
  ramp_tick_ = 0;
  force_.from = force_.previous;
  torque_.from = torque_.previous;
}

/// The fraction of a wrench that is left in this tick, 0 to 1.
double SafetyStage::next_fade(bool fading) noexcept {
  if (fading) {
    fade_tick_ = std::min(fade_tick_ + 1, settings_.fade_ticks);
  } else if (fade_tick_ > 0) {
    fade_tick_ = 0;
    restart();
  }
  return 1 - static_cast<double>(fade_tick_) / settings_.fade_ticks;
}

SafeWrench SafetyStage::apply(const Wrench& wanted, ForceOff cause, bool fading) noexcept {
  SafeWrench safe;
  const bool finite = wanted.force.allFinite() && wanted.torque.allFinite();
  if (cause == ForceOff::none && !finite) cause = ForceOff::not_a_number;
  const double left = next_fade(fading);
  if (cause == ForceOff::none && left == 0) cause = ForceOff::application_silent;
  if (cause != ForceOff::none) {
    safe.cause = cause;
    force_.previous.setZero();
    torque_.previous.setZero();
    restart();
    return safe;
  }

  ramp_tick_ = std::min(ramp_tick_ + 1, settings_.ramp_ticks);
  const double share = static_cast<double>(ramp_tick_) / settings_.ramp_ticks;
  const Vector3 force = left * ramped(force_.from, wanted.force, share);
  const Vector3 torque = left * ramped(torque_.from, wanted.torque, share);
  safe.force = limit_slew(force_.previous, force, settings_.slew_limit);
  safe.torque = limit_slew(torque_.previous, torque, settings_.torque_slew);
  safe.slewed = safe.force != force;
  safe.torque_slewed = safe.torque != torque;
  safe.capped = cap_to(safe.force, settings_.force_cap);
  safe.torque_capped = cap_to(safe.torque, settings_.torque_cap);
  force_.previous = safe.force;
  torque_.previous = safe.torque;
  return safe;
}

}  // namespace spm::servo
