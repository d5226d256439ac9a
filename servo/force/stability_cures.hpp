// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "servo/force/braking_velocity.hpp"
#include "common/contact/force_law.hpp"
#include "servo/force/matched_damping.hpp"
#include "servo/force/passivity_control.hpp"
#include "common/contact/stabilization_settings.hpp"

namespace spm {

/// What a contact's force can give back, for the observer.
struct ContactEnergy {
  double stiffness = 0;  ///< N/m of the hand, of all that touches it together
  double stored = 0;     ///< J, in the springs of the contact
  double carried = 0;    ///< J, that objects which moved did on the hand since the last tick
};

/// The cures that act on the sum of the objects' forces, whatever made it, tick by tick; coupling
/// and potential are each object's. A tick allocates nothing and does not throw.
class StabilityCures {
 public:
  /// `tick` in s, above 0; `encoder_step` in m of the hand, 0 or more.
  StabilityCures(const CureSettings& settings, double tick, double encoder_step) noexcept;

  /// The force to send for what the law wants with the hand at `hand` (m, the same frame). What is
  /// wanted comes back as it is where there is no contact, or no cure. Never NaN: a position or a
  /// force that is not finite gives zero, and what came before is forgotten.
  [[nodiscard]] ContactForce apply(const ContactForce& wanted, const Vector3& hand,
                                   const ContactEnergy& energy) noexcept;

  /// Forgets all: at the start, and when what is felt was exchanged.
  void reset() noexcept;

 private:
  [[nodiscard]] Vector3 damped(const Vector3& velocity, const Vector3& reaction,
                               double stiffness) const noexcept;

  CureSettings settings_;
  double tick_;
  double most_damping_;  ///< N s/m
  double encoder_step_;  ///< m
  BrakingVelocity velocity_;
  PassivityControl passivity_;
};

}  // namespace spm
