// SPDX-License-Identifier: Apache-2.0
#include "servo/force/stability_cures.hpp"

#include <algorithm>

namespace spm {

StabilityCures::StabilityCures(const CureSettings& settings, double tick,
                               double encoder_step) noexcept
    : settings_(settings),
      tick_(tick),
      most_damping_(spm::most_damping(settings.device_mass, tick, settings.whole_delay(tick))),
      encoder_step_(encoder_step),
      velocity_(encoder_step, tick, settings.velocity),
      passivity_({settings.whole_delay(tick), tick, encoder_step, settings.device_mass}) {}

void StabilityCures::reset() noexcept {
  velocity_.reset();
  passivity_.reset();
}

/// The force, N, that matched damping adds to a reaction (N) of that stiffness.
Vector3 StabilityCures::damped(const Vector3& velocity, const Vector3& reaction,
                               double stiffness) const noexcept {
  const double damping = std::min(
      matched_damping(settings_.damping_share, stiffness, settings_.whole_delay(tick_), tick_),
      most_damping_);
  const double whole_from =
      std::max(whole_braking_from, whole_braking_steps * stiffness * encoder_step_);
  return along_reaction(-damping * velocity, reaction, whole_from);
}

ContactForce StabilityCures::apply(const ContactForce& wanted, const Vector3& hand,
                                   const ContactEnergy& energy) noexcept {
  if (!hand.allFinite() || !wanted.force.allFinite()) {
    reset();
    return {};
  }
  if (!settings_.acts_on_sum()) return wanted;
  velocity_.take(hand);
  if (!wanted.contact || !(energy.stiffness > 0)) {
    passivity_.rest();
    return wanted;
  }
  const Vector3 velocity = velocity_.now();
  ContactForce cured = wanted;
  if (settings_.damping_share > 0) cured.force += damped(velocity, wanted.force, energy.stiffness);
  if (settings_.passivity) {
    cured.force = passivity_.next(cured.force, hand, velocity, energy.stiffness, energy.stored,
                                  energy.carried);
  }
  if (cured.force.allFinite()) return cured;
  reset();
  return {};
}

}  // namespace spm
