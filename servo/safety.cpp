// SPDX-License-Identifier: Apache-2.0
#include "servo/safety.hpp"

#include <algorithm>
#include <cmath>

namespace spm::servo {

namespace {

constexpr double fastest_hand = 1.0;  // m/s
constexpr double slew_margin = 2.0;
constexpr double least_slew = 1.0;  // N a tick, so that a soft asset is not held back by rounding
constexpr double ramp_seconds = 0.1;

/// Limits how far the force may grow or turn in a tick. Falling is free: a force that ends must
/// end.
Vector3 limit_slew(const Vector3& previous, const Vector3& wanted, double limit) noexcept {
  const double before = previous.norm();
  const double after = wanted.norm();
  const Vector3 from = before > after ? Vector3(previous * (after / before)) : previous;
  const Vector3 step = wanted - from;
  const double size = step.norm();
  return size > limit ? Vector3(from + step * (limit / size)) : wanted;
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
      return "check the device's cable and power";
    case ForceOff::device_silent:
      return "check the device's cable, its power and the hub; the loop goes on when it answers";
    case ForceOff::device_gone:
      return "plug the device in again, the loop takes it up by itself";
    case ForceOff::not_homed:
      return "move the tool through its whole range once, as the device's page says";
    case ForceOff::jumped:
      return "check the device's encoders and its cable; the force fades in again by itself";
    case ForceOff::clutched:
      return "let the clutch go, in the application that holds it";
  }
  return "";
}

bool JumpGate::jumped(const Vector3& position, std::uint64_t tick) noexcept {
  const double ticks = static_cast<double>(tick > last_tick_ ? tick - last_tick_ : 1);
  const bool is_too_far = is_known_ && (position - last_).norm() > most_a_tick_ * ticks;
  last_ = position;
  last_tick_ = tick;
  is_known_ = true;
  return is_too_far;
}

SafetySettings safety_settings(double force_cap, double stiffness, double rate_hz) noexcept {
  SafetySettings settings;
  settings.force_cap = force_cap;
  settings.slew_limit = std::max(least_slew, slew_margin * stiffness * fastest_hand / rate_hz);
  settings.ramp_ticks =
      std::max(1U, static_cast<std::uint32_t>(std::lround(ramp_seconds * rate_hz)));
  return settings;
}

SafeForce SafetyStage::apply(const Vector3& wanted, ForceOff cause) noexcept {
  SafeForce safe;
  if (cause == ForceOff::none && !wanted.allFinite()) cause = ForceOff::not_a_number;
  if (cause != ForceOff::none) {
    safe.cause = cause;
    previous_.setZero();
    restart();
    return safe;
  }

  ramp_tick_ = std::min(ramp_tick_ + 1, settings_.ramp_ticks);
  safe.force = wanted * (static_cast<double>(ramp_tick_) / settings_.ramp_ticks);

  const Vector3 slewed = limit_slew(previous_, safe.force, settings_.slew_limit);
  safe.slewed = slewed != safe.force;
  safe.force = slewed;

  const double size = safe.force.norm();
  if (size > settings_.force_cap) {
    safe.force *= settings_.force_cap / size;
    safe.capped = true;
  }
  previous_ = safe.force;
  return safe;
}

}  // namespace spm::servo
