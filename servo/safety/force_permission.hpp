// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "servo/safety/safety.hpp"

namespace spm::servo {

/// What a person has to do before there is force.
struct PermissionSettings {
  /// after a fault somebody has to say that all is well again; after a runaway, always
  bool acknowledge = false;
  std::uint32_t enable_button = 0;  ///< without it held there is no force; from 1, 0: none
  std::uint32_t clutch_button = 0;  ///< its presses acknowledge nothing; from 1, 0: none
};

/// Whether a cause is a fault, after which a force comes back by itself unless somebody has to
/// acknowledge it.
[[nodiscard]] bool needs_acknowledgement(ForceOff cause) noexcept;

/// What a person and applications say in a tick.
struct PermissionSigns {
  bool buttons_known = false;  ///< the device can be trusted
  std::uint32_t buttons = 0;
  bool acknowledged = false;  ///< by an application
  bool at_fault = false;      ///< something is wrong now
};

/// Whether a hand may get force although nothing is wrong: an enable switch is held, and faults
/// were acknowledged. A press of a button of the device acknowledges too. While the fault lasts
/// nothing does, nor does a button that was held through it. No call allocates or throws.
class ForcePermission {
 public:
  explicit ForcePermission(const PermissionSettings& settings) noexcept : settings_(settings) {}

  /// Call it in each tick. `none` if the hand may get force; `unacknowledged` or `not_enabled`.
  [[nodiscard]] ForceOff next(const PermissionSigns& signs) noexcept;

  /// Tells what was sent in the tick: zero force for a cause, or force.
  void sent(ForceOff cause) noexcept;

 private:
  [[nodiscard]] bool is_pressed_anew(const PermissionSigns& signs) noexcept;

  PermissionSettings settings_;
  std::uint32_t held_ = ~0U;  ///< buttons that are held since they were last seen up
  bool had_force_ = false;    ///< before that there is nothing to come back
  bool waits_ = false;
};

}  // namespace spm::servo
