// SPDX-License-Identifier: Apache-2.0
#include "common/passivity_control.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/matched_damping.hpp"

namespace spm {

namespace {

/// N: one encoder step in a tick shall not be answered by more.
constexpr double step_force = 0.1;

double most_of(const PassivitySettings& settings) noexcept {
  const double by_step = settings.encoder_step > 0
                             ? step_force * settings.tick / settings.encoder_step
                             : std::numeric_limits<double>::infinity();
  return std::min(most_damping(settings.device_mass, settings.tick), by_step);
}

}  // namespace

PassivityControl::PassivityControl(const PassivitySettings& settings) noexcept
    : tick_(settings.tick), encoder_step_(settings.encoder_step), most_damping_(most_of(settings)) {
  const double delay = std::clamp(settings.delay_ticks, 0.0, most_delay_ticks);
  whole_delay_ = static_cast<std::size_t>(delay);
  part_delay_ = delay - static_cast<double>(whole_delay_);
}

void PassivityControl::reset() noexcept {
  sent_ = {};
  stored_ = generated_ = 0;
  touching_ = came_free_ = false;
}

void PassivityControl::send(const Sent& sent) noexcept {
  newest_ = (newest_ + 1) % kept;
  sent_[newest_] = sent;
}

void PassivityControl::rest() noexcept {
  send({});
  stored_ = generated_ = 0;
  touching_ = false;
  came_free_ = true;
}

/// Adds up what the tick that is over gave the hand.
void PassivityControl::observe(const Vector3& moved, double stiffness, double stored,
                               double carried) noexcept {
  // In it acted, for a part of it, what was sent a tick later.
  const Vector3 acted =
      (1 - part_delay_) * ago(whole_delay_).force + part_delay_ * ago(whole_delay_ + 1).force;
  generated_ += acted.dot(moved) + stored - stored_ - carried;
  // A reading that changes by a step may stand for no motion at all: as much as this is the
  // encoder's, by the sum over the steps there and back.
  generated_ -= 0.5 * stiffness * encoder_step_ * std::min(moved.norm(), encoder_step_);
  generated_ = std::max(generated_, -most_credit);
}

Vector3 PassivityControl::next(const Vector3& wanted, const Vector3& hand, const Vector3& velocity,
                               double stiffness, double stored, double carried) noexcept {
  if (touching_) {
    observe(hand - hand_, stiffness, stored, carried);
  } else {
    // What was pressed in the first tick, no force has answered; unless the contact is older.
    generated_ = came_free_ ? stored : 0;
  }
  touching_ = true;
  hand_ = hand;
  stored_ = stored;
  // What the dampings that do not act yet will take.
  double left = generated_;
  for (std::size_t ticks = 0; ticks < whole_delay_; ++ticks) left -= ago(ticks).taken;
  Sent sent{wanted, 0};
  const double power = velocity.squaredNorm();
  if (left > 0 && power > 0) {
    const double damping = std::min(left / (spread_ticks * tick_ * power), most_damping_);
    const Vector3 braking = within_reaction(-damping * velocity, wanted.norm());
    sent.force += braking;
    sent.taken = -braking.dot(velocity) * tick_;
  }
  if (!sent.force.allFinite() || !std::isfinite(generated_)) {
    reset();
    return wanted;
  }
  send(sent);
  return sent.force;
}

}  // namespace spm
