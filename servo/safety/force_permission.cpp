// SPDX-License-Identifier: Apache-2.0
#include "servo/safety/force_permission.hpp"

#include <utility>

namespace spm::servo {

namespace {

std::uint32_t bit_of(std::uint32_t button) noexcept { return button > 0 ? 1U << (button - 1) : 0; }

}  // namespace

bool needs_acknowledgement(ForceOff cause) noexcept {
  switch (cause) {
    case ForceOff::asset_lost:
    case ForceOff::not_a_number:
    case ForceOff::device_fault:
    case ForceOff::device_silent:
    case ForceOff::device_gone:
    case ForceOff::not_homed:
    case ForceOff::jumped:
    case ForceOff::outside_workspace:
    case ForceOff::application_silent:
    case ForceOff::stalled:
    case ForceOff::runaway:
      return true;
    case ForceOff::none:
    case ForceOff::starting:
    case ForceOff::stopping:
    case ForceOff::clutched:
    case ForceOff::unacknowledged:
    case ForceOff::not_enabled:
    case ForceOff::unconfirmed:
      return false;
  }
  return true;
}

/// A device that was away may come back with a button held: that is no press.
bool ForcePermission::is_pressed_anew(const PermissionSigns& signs) noexcept {
  const std::uint32_t before = std::exchange(held_, signs.buttons_known ? signs.buttons : ~0U);
  return signs.buttons_known && (signs.buttons & ~before & ~bit_of(settings_.clutch_button)) != 0;
}

ForceOff ForcePermission::next(const PermissionSigns& signs) noexcept {
  const bool pressed = is_pressed_anew(signs);
  if (waits_ && !signs.at_fault && (pressed || signs.acknowledged)) waits_ = false;
  if (waits_) return ForceOff::unacknowledged;
  const std::uint32_t enabling = bit_of(settings_.enable_button);
  const bool enabled = enabling == 0 || (signs.buttons_known && (signs.buttons & enabling) != 0);
  return enabled ? ForceOff::none : ForceOff::not_enabled;
}

void ForcePermission::sent(ForceOff cause) noexcept {
  if (cause == ForceOff::none) had_force_ = true;
  // What pushes the wrong way does so again.
  const bool must_wait = settings_.acknowledge || cause == ForceOff::runaway;
  if (must_wait && had_force_ && needs_acknowledgement(cause)) waits_ = true;
}

}  // namespace spm::servo
