// SPDX-License-Identifier: Apache-2.0
#include "servo/stabilize/wrench_stabilizer.hpp"

#include <algorithm>

#include "common/base/turn_between.hpp"
#include "servo/stabilize/turning_lever.hpp"

namespace spm {

namespace {

/// The settings that the damping of the place or of the turn needs. Both share one energy account.
StabilizationSettings damping_of(StabilizationSettings stabilization, double mass) noexcept {
  stabilization.passivity = false;
  stabilization.device_mass = mass;
  return stabilization;
}

PassivitySettings account_of(const StabilizationSettings& stabilization,
                             const WrenchLoop& loop) noexcept {
  PassivitySettings account;
  account.delay_ticks = stabilization.total_delay(loop.tick);
  account.tick = loop.tick;
  account.encoder_step = loop.encoder_step;
  account.device_mass = stabilization.device_mass;
  account.turn_step = loop.turn_step * turning_lever;
  account.turning_inertia = at_lever(loop.turning_inertia);
  return account;
}

}  // namespace

WrenchStabilizer::WrenchStabilizer(const StabilizationSettings& settings,
                                   const WrenchLoop& loop) noexcept
    : loop_(loop),
      acts_(settings.acts_on_sum()),
      controls_(settings.passivity),
      forces_(damping_of(settings, settings.device_mass), loop.tick, loop.encoder_step),
      torques_(damping_of(settings, at_lever(loop.turning_inertia)), loop.tick,
               loop.turn_step * turning_lever),
      place_(account_of(settings, loop)),
      both_(account_of(settings, loop)),
      place_speed_(loop.encoder_step, loop.tick, settings.velocity),
      turn_speed_(loop.turn_step * turning_lever, loop.tick, settings.velocity) {}

void WrenchStabilizer::reset() noexcept {
  forces_.reset();
  torques_.reset();
  place_.reset();
  both_.reset();
  place_speed_.reset();
  turn_speed_.reset();
  hand_.setZero();
  known_ = false;
}

/// The turn is summed from small turns: only along these is the torque's work their product.
void WrenchStabilizer::move_to(const HandPose& hand) noexcept {
  const Vector3 turn = known_ ? turn_between(orientation_, hand.orientation) : Vector3::Zero();
  const Vector3 turned = hand_.tail<3>() + turning_lever * turn;
  hand_ << hand.position, turned;
  orientation_ = hand.orientation;
  known_ = true;
}

WrenchStabilizer::Vector WrenchStabilizer::controlled(const Vector& wanted,
                                                      const WrenchEnergy& energy) noexcept {
  Vector velocity;
  velocity << place_speed_.now(), turn_speed_.now();
  if (loop_.torque) {
    const double stiffness = std::max(energy.stiffness, at_lever(energy.turning));
    return both_.next(wanted, hand_, velocity, stiffness, energy.stored, energy.carried);
  }
  Vector controlled = Vector::Zero();
  controlled.head<3>() = place_.next(wanted.head<3>(), hand_.head<3>(), velocity.head<3>(),
                                     energy.stiffness, energy.stored, energy.carried);
  return controlled;
}

Wrench WrenchStabilizer::apply(const Wrench& wanted, bool contact, const HandPose& hand,
                               const WrenchEnergy& energy, std::uint64_t ticks) noexcept {
  Wrench felt{wanted.force, loop_.torque ? wanted.torque : Vector3(Vector3::Zero())};
  if (!hand.position.allFinite() || !hand.orientation.coeffs().allFinite() ||
      !felt.force.allFinite() || !felt.torque.allFinite()) {
    reset();
    return {};
  }
  if (!acts_) return felt;
  move_to(hand);
  const Vector3 turned = hand_.tail<3>();
  ContactForce force, torque;
  force.contact = torque.contact = contact;
  force.force = felt.force;
  torque.force = felt.torque / turning_lever;
  Vector stabilized;
  stabilized << forces_.apply(force, hand.position, {energy.stiffness, 0, 0}, ticks).force,
      torques_.apply(torque, turned, {at_lever(energy.turning), 0, 0}, ticks).force;
  if (controls_) {
    place_speed_.take(hand.position, ticks);
    turn_speed_.take(turned, ticks);
    if (contact) {
      stabilized = controlled(stabilized, energy);
    } else {
      place_.rest();
      both_.rest();
    }
  }
  if (!stabilized.allFinite()) {
    reset();
    return {};
  }
  return {stabilized.head<3>(), turning_lever * stabilized.tail<3>()};
}

void WrenchStabilizer::sent(const Wrench& wrench) noexcept {
  if (!controls_) return;
  if (!loop_.torque) {
    place_.sent(wrench.force);
    return;
  }
  Vector sent;
  sent << wrench.force, wrench.torque / turning_lever;
  both_.sent(sent);
}

}  // namespace spm
