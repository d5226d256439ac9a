// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/contact/force_law.hpp"
#include "common/contact/stabilization_settings.hpp"
#include "servo/stabilize/braking_velocity.hpp"
#include "servo/stabilize/matched_damping.hpp"
#include "servo/stabilize/passivity_control.hpp"

namespace spm {

/// The energy that a contact's force can give back, for the observer.
struct ContactEnergy {
  double stiffness = 0;  ///< N/m of the hand, of all objects that touch it together
  double stored = 0;     ///< J, in the springs of the contact
  double carried = 0;    ///< J, work on the hand since the last tick by objects that moved
};

/// The stabilization that acts on the sum of the objects' forces, whatever their method, tick by
/// tick. Coupling and potential act within each object instead. A tick allocates nothing and does
/// not throw.
class Stabilizer {
 public:
  /// `tick` in s, above 0; `encoder_step` in m of the hand, 0 or more.
  Stabilizer(const StabilizationSettings& settings, double tick, double encoder_step) noexcept;

  /// The force to send, when the force law wants `wanted` with the hand at `hand` (m, the same
  /// frame). It is `wanted` itself if there is no contact, or no stabilization is on. Never NaN: a
  /// position or a force that is not finite gives zero, and all state is forgotten.
  /// `ticks`: since the last one.
  [[nodiscard]] ContactForce apply(const ContactForce& wanted, const Vector3& hand,
                                   const ContactEnergy& energy, std::uint64_t ticks = 1) noexcept;

  /// Tells what was sent of the force that `apply` returned, N, the hand's frame. Without it all of
  /// it counts as sent.
  void sent(const Vector3& force) noexcept { passivity_.sent(force); }

  /// Forgets all state: at the start, and when what is felt was exchanged.
  void reset() noexcept;

 private:
  [[nodiscard]] Vector3 damped(const Vector3& velocity, const Vector3& reaction,
                               double stiffness) const noexcept;

  StabilizationSettings settings_;
  double tick_;
  double max_damping_;   ///< N s/m
  double encoder_step_;  ///< m
  BrakingVelocity velocity_;
  PassivityControl passivity_;
};

}  // namespace spm
