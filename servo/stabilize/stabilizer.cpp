// SPDX-License-Identifier: Apache-2.0
#include "servo/stabilize/stabilizer.hpp"

#include <algorithm>

namespace spm {

Stabilizer::Stabilizer(const StabilizationSettings& settings, double tick,
                       double encoder_step) noexcept
    : settings_(settings),
      tick_(tick),
      max_damping_(spm::max_damping(settings.device_mass, tick, settings.total_delay(tick))),
      encoder_step_(encoder_step),
      velocity_(encoder_step, tick, settings.velocity),
      passivity_({settings.total_delay(tick), tick, encoder_step, settings.device_mass}) {}

void Stabilizer::reset() noexcept {
  velocity_.reset();
  passivity_.reset();
}

/// The force, N, that matched damping adds to a reaction (N) of that stiffness.
Vector3 Stabilizer::damped(const Vector3& velocity, const Vector3& reaction,
                           double stiffness) const noexcept {
  const double damping = std::min(
      matched_damping(settings_.damping_share, stiffness, settings_.total_delay(tick_), tick_),
      max_damping_);
  const double full_from =
      std::max(full_braking_reaction, full_braking_steps * stiffness * encoder_step_);
  return along_reaction(-damping * velocity, reaction, full_from);
}

ContactForce Stabilizer::apply(const ContactForce& wanted, const Vector3& hand,
                               const ContactEnergy& energy, std::uint64_t ticks) noexcept {
  if (!hand.allFinite() || !wanted.force.allFinite()) {
    reset();
    return {};
  }
  if (!settings_.acts_on_sum()) return wanted;
  velocity_.take(hand, ticks);
  if (!wanted.contact || !(energy.stiffness > 0)) {
    passivity_.rest();
    return wanted;
  }
  const Vector3 velocity = velocity_.now();
  ContactForce stabilized = wanted;
  if (settings_.damping_share > 0)
    stabilized.force += damped(velocity, wanted.force, energy.stiffness);
  if (settings_.passivity) {
    stabilized.force = passivity_.next(stabilized.force, hand, velocity, energy.stiffness,
                                       energy.stored, energy.carried);
  }
  if (stabilized.force.allFinite()) return stabilized;
  reset();
  return {};
}

}  // namespace spm
