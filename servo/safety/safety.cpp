// SPDX-License-Identifier: Apache-2.0
#include "servo/safety/safety.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/smooth_change.hpp"
#include "common/base/turn_between.hpp"

namespace spm::servo {

namespace {

constexpr double fastest_hand = 1.0;  // m/s
constexpr double slew_margin = 2.0;
constexpr double min_slew = 1.0;  // N a tick, so that a soft asset is not limited by rounding

/// Limits how far a force or torque may grow or turn in a tick. Decrease is not limited: a force
/// that is wanted no longer is not sent.
Vector3 limit_slew(const Vector3& previous, const Vector3& wanted, double limit) noexcept {
  const double before = previous.norm();
  const double after = wanted.norm();
  const Vector3 from = before > after ? Vector3(previous * (after / before)) : previous;
  const Vector3 step = wanted - from;
  const double size = step.norm();
  return size > limit ? Vector3(from + step * (limit / size)) : wanted;
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
  settings.tick = 1 / rate_hz;
  return settings;
}

/// Takes the share of what is wanted nearer to all of it, or to none of it.
void SafetyStage::step_share(const Wrench& wanted, Fade fade, std::uint64_t ticks) noexcept {
  const double seconds = static_cast<double>(ticks) * settings_.tick;
  if (fade == Fade::silent) {
    share_ = std::max(0.0, share_ - seconds / silent_fade_seconds);
    return;
  }
  const double step = change_share(seconds, std::min(wanted.force.norm(), force_cap_));
  share_ = fade == Fade::clutch ? std::max(0.0, share_ - step) : std::min(1.0, share_ + step);
}

SafeWrench SafetyStage::apply(const Wrench& wanted, ForceOff cause, Fade fade,
                              std::uint64_t ticks) noexcept {
  SafeWrench safe;
  const bool finite = wanted.force.allFinite() && wanted.torque.allFinite();
  if (cause == ForceOff::none && !finite) cause = ForceOff::not_a_number;
  const double most = change_rate * static_cast<double>(ticks) * settings_.tick;
  const bool was_off = is_off();
  if (cause == ForceOff::none) {
    step_share(wanted, fade, ticks);
    if (is_off()) cause = fade == Fade::clutch ? ForceOff::clutched : ForceOff::application_silent;
  }
  // No force is felt that a lower cap could take away at once.
  force_cap_ = was_off ? settings_.force_cap
                       : force_cap_ + std::clamp(settings_.force_cap - force_cap_, -most, most);
  if (cause != ForceOff::none) {
    safe.cause = cause;
    share_ = 0;
    last_force_.setZero();
    last_torque_.setZero();
    return safe;
  }

  const Vector3 force = share_ * wanted.force;
  const Vector3 torque = share_ * wanted.torque;
  safe.force = limit_slew(last_force_, force, settings_.slew_limit);
  safe.torque = limit_slew(last_torque_, torque, settings_.torque_slew);
  safe.slewed = safe.force != force;
  safe.torque_slewed = safe.torque != torque;
  safe.capped = cap_to(safe.force, force_cap_);
  safe.torque_capped = cap_to(safe.torque, settings_.torque_cap);
  last_force_ = safe.force;
  last_torque_ = safe.torque;
  return safe;
}

}  // namespace spm::servo
