// SPDX-License-Identifier: Apache-2.0
#include "servo/stabilize/passivity_control.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "servo/stabilize/matched_damping.hpp"

namespace spm {

namespace {

/// N: the largest answer to one encoder step in a tick.
constexpr double step_force = 0.1;

double max_of(double mass, double encoder_step, double tick) noexcept {
  const double by_step =
      encoder_step > 0 ? step_force * tick / encoder_step : std::numeric_limits<double>::infinity();
  return std::min(max_damping(mass, tick), by_step);
}

/// The components of one part: the position, or the rotation.
template <class Vector>
Vector3 part_of(const Vector& vector, std::size_t part) noexcept {
  return vector.template segment<3>(3 * static_cast<Eigen::Index>(part));
}

}  // namespace

template <int components>
PassivityControlOf<components>::PassivityControlOf(const PassivitySettings& settings) noexcept
    : tick_(settings.tick) {
  encoder_step_[0] = settings.encoder_step;
  max_damping_[0] = max_of(settings.device_mass, settings.encoder_step, tick_);
  if constexpr (parts > 1) {
    encoder_step_[1] = settings.turn_step;
    max_damping_[1] = max_of(settings.turning_inertia, settings.turn_step, tick_);
  }
  const double delay = std::clamp(settings.delay_ticks, 0.0, max_delay_ticks);
  integer_delay_ = static_cast<std::size_t>(delay);
  fractional_delay_ = delay - static_cast<double>(integer_delay_);
}

template <int components>
void PassivityControlOf<components>::reset() noexcept {
  sent_ = {};
  stored_ = generated_ = 0;
  touching_ = came_free_ = false;
}

template <int components>
void PassivityControlOf<components>::send(const Sent& sent) noexcept {
  newest_ = (newest_ + 1) % kept;
  sent_[newest_] = sent;
}

template <int components>
void PassivityControlOf<components>::sent(const Vector& force) noexcept {
  if (!touching_ || !force.allFinite()) return;
  Sent& newest = sent_[newest_];
  const double planned = newest.force.norm(), size = force.norm();
  if (size < planned) newest.taken *= size / planned;
  newest.force = force;
}

template <int components>
void PassivityControlOf<components>::rest() noexcept {
  send({});
  stored_ = generated_ = 0;
  touching_ = false;
  came_free_ = true;
}

/// The part of a motion (m) that may come from the encoder alone. The three axes of a point count
/// as one encoder. A tool that is held on several sides swings along two or three axes at once.
template <int components>
double PassivityControlOf<components>::within_step(const Vector3& moved, double step) noexcept {
  if constexpr (components == 3) return std::min(moved.norm(), step);
  return moved.cwiseAbs().cwiseMin(step).sum();
}

/// Adds the energy that the finished tick gave the hand.
template <int components>
void PassivityControlOf<components>::observe(const Vector& moved, double stiffness, double stored,
                                             double carried) noexcept {
  // For a part of the tick, the force that was sent a tick later acted.
  const Vector acted = (1 - fractional_delay_) * ago(integer_delay_).force +
                       fractional_delay_ * ago(integer_delay_ + 1).force;
  generated_ += acted.dot(moved) + stored - stored_ - carried;
  // A reading that changes by one step may stand for no motion at all. This much is attributed to
  // the encoder, by the sum over the steps there and back.
  for (std::size_t part = 0; part < parts; ++part) {
    const double step = encoder_step_[part];
    generated_ -= 0.5 * stiffness * step * within_step(part_of(moved, part), step);
  }
  generated_ = std::max(generated_, -max_credit);
}

/// The force that takes this much energy (J) over the next ticks. `power`: the velocity squared.
template <int components>
auto PassivityControlOf<components>::braking(const Vector& velocity, double power,
                                             double left) const noexcept -> Vector {
  const double damping = left / (spread_ticks * tick_ * power);
  Vector braking;
  for (std::size_t part = 0; part < parts; ++part) {
    braking.template segment<3>(3 * static_cast<Eigen::Index>(part)) =
        -std::min(damping, max_damping_[part]) * part_of(velocity, part);
  }
  return braking;
}

template <int components>
auto PassivityControlOf<components>::next(const Vector& wanted, const Vector& hand,
                                          const Vector& velocity, double stiffness, double stored,
                                          double carried) noexcept -> Vector {
  if (touching_) {
    observe(hand - hand_, stiffness, stored, carried);
  } else {
    // No force has answered what was pressed in the first tick, unless the contact is older.
    generated_ = came_free_ ? stored : 0;
  }
  touching_ = true;
  hand_ = hand;
  stored_ = stored;
  // The energy that dampings which do not act yet will take.
  double left = generated_;
  for (std::size_t ticks = 0; ticks < integer_delay_; ++ticks) left -= ago(ticks).taken;
  Sent sent{wanted, 0};
  const double power = velocity.squaredNorm();
  if (left > 0 && power > 0) {
    const Vector brake = braking(velocity, power, left);
    const double share = braking_share(brake.norm(), wanted.norm());
    if (share > 0) {
      sent.force += share * brake;
      sent.taken = -(share * brake).dot(velocity) * tick_;
    }
  }
  if (!sent.force.allFinite() || !std::isfinite(generated_)) {
    reset();
    return wanted;
  }
  send(sent);
  return sent.force;
}

template class PassivityControlOf<3>;
template class PassivityControlOf<6>;

}  // namespace spm
