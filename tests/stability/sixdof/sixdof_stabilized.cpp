// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/sixdof/sixdof_stabilized.hpp"

#include <algorithm>
#include <utility>

namespace spm::stability {

namespace {

/// The stabilizer settings that the damping of the place or of the turn needs. Both share one
/// energy account.
StabilizationSettings damping_of(StabilizationSettings stabilization, double mass) {
  stabilization.passivity = false;
  stabilization.device_mass = mass;
  return stabilization;
}

double at_lever(double inertia) { return inertia / (sixdof_lever * sixdof_lever); }

PassivitySettings account_of(const StabilizationSettings& stabilization, const SixdofLoop& loop) {
  PassivitySettings account;
  account.delay_ticks = stabilization.total_delay(loop.period);
  account.tick = loop.period;
  account.encoder_step = loop.encoder_step;
  account.device_mass = stabilization.device_mass;
  account.turn_step = loop.turn_step * sixdof_lever;
  account.turning_inertia = at_lever(loop.turning_inertia);
  return account;
}

}  // namespace

StabilizedWrench::StabilizedWrench(std::unique_ptr<SixdofContestant> law,
                                   const StabilizationSettings& settings, const SixdofLoop& loop)
    : law_(std::move(law)),
      controls_(settings.passivity),
      forces_(damping_of(settings, settings.device_mass), loop.period, loop.encoder_step),
      torques_(damping_of(settings, at_lever(loop.turning_inertia)), loop.period,
               loop.turn_step * sixdof_lever),
      passivity_(account_of(settings, loop)),
      place_speed_(loop.encoder_step, loop.period),
      turn_speed_(loop.turn_step * sixdof_lever, loop.period) {}

void StabilizedWrench::begin(const Eigen::Isometry3d& start) {
  law_->begin(start);
  forces_.reset();
  torques_.reset();
  passivity_.reset();
  place_speed_.reset();
  turn_speed_.reset();
  orientation_ = Eigen::Quaterniond(start.linear());
  hand_ << start.translation(), Vector3::Zero();
}

/// The turn is summed from small turns: only along these is the torque's work their product.
Vector3 StabilizedWrench::moved_to(const Eigen::Isometry3d& measured) noexcept {
  const Eigen::Quaterniond orientation(measured.linear());
  Vector3 turned = hand_.tail<3>() + sixdof_lever * turn_between(orientation_, orientation);
  orientation_ = orientation;
  hand_ << measured.translation(), turned;
  return turned;
}

StabilizedWrench::Vector StabilizedWrench::controlled(const Vector& wanted,
                                                      const SixdofAnswer& answer) noexcept {
  place_speed_.take(hand_.head<3>());
  turn_speed_.take(hand_.tail<3>());
  if (!answer.contact) {
    passivity_.rest();
    return wanted;
  }
  Vector velocity;
  velocity << place_speed_.now(), turn_speed_.now();
  const double stiffness = std::max(answer.stiffness, at_lever(answer.turning));
  return passivity_.next(wanted, hand_, velocity, stiffness, answer.stored, 0);
}

SixdofAnswer StabilizedWrench::next(const Eigen::Isometry3d& measured) {
  SixdofAnswer answer = law_->next(measured);
  const Vector3 turned = moved_to(measured);
  ContactForce force, torque;
  force.contact = torque.contact = answer.contact;
  force.force = answer.wrench.force;
  torque.force = answer.wrench.torque / sixdof_lever;
  Vector stabilized;
  stabilized << forces_.apply(force, measured.translation(), {answer.stiffness, 0, 0}).force,
      torques_.apply(torque, turned, {at_lever(answer.turning), 0, 0}).force;
  if (controls_) stabilized = controlled(stabilized, answer);
  answer.wrench = {stabilized.head<3>(), sixdof_lever * stabilized.tail<3>()};
  return answer;
}

}  // namespace spm::stability
