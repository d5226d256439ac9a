// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/sim_dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace spm::servo {

namespace {

constexpr int least_substeps = 20;
constexpr double longest_substep = 50e-6;  // s

/// Coulomb friction as the largest change of velocity that it can make in a substep: a slower tool
/// stops, and stays until something stronger pulls.
Vector3 rub(const Vector3& velocity, double largest_change) noexcept {
  const double speed = velocity.norm();
  if (speed <= largest_change) return Vector3::Zero();
  return velocity * (1 - largest_change / speed);
}

}  // namespace

SimDynamics::SimDynamics(const SimProfile& profile, double period) noexcept
    : profile_(profile),
      substeps_(std::max(least_substeps, static_cast<int>(std::ceil(period / longest_substep)))),
      step_(period / substeps_),
      lag_gain_(1 - std::exp(-2 * std::numbers::pi * profile.bandwidth * step_)) {}

void SimDynamics::place(const Vector3& position) noexcept {
  position_ = position;
  velocity_.setZero();
  actuator_.setZero();
}

void SimDynamics::step(const Vector3& commanded, const HandTarget& target, double stiffness,
                       double damping) noexcept {
  const double size = commanded.norm();
  const Vector3 reachable =
      size > profile_.force_cap ? Vector3(commanded * (profile_.force_cap / size)) : commanded;
  for (int substep = 1; substep <= substeps_; ++substep) {
    actuator_ += lag_gain_ * (reachable - actuator_);
    const Vector3 wanted = target.position - (substeps_ - substep) * step_ * target.velocity;
    const Vector3 force = actuator_ + stiffness * (wanted - position_) +
                          damping * (target.velocity - velocity_) - profile_.damping * velocity_;
    velocity_ += force * (step_ / profile_.mass);
    velocity_ = rub(velocity_, profile_.friction * step_ / profile_.mass);
    position_ += velocity_ * step_;
  }
}

Vector3 SimDynamics::measured_position() const noexcept {
  const double size = profile_.encoder_step;
  return (position_ / size).array().round().matrix() * size;
}

}  // namespace spm::servo
