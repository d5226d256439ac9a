// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/sim_plant.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace spm::servo {

namespace {

constexpr int min_substeps = 20;
constexpr double longest_substep = 50e-6;  // s
constexpr int friction_rounds = 30;        // of Newton's method; about four are enough
constexpr double friction_found = 1e-13;

/// Seeds of the two sources of random numbers, so that one setting does not change the other's.
constexpr std::uint64_t noise_seed = 0x6E6F697365;

}  // namespace

int substeps_for(double period) noexcept {
  // Slightly reduced, so that 1 ms is 20 substeps in spite of rounding.
  return std::max(min_substeps, static_cast<int>(std::ceil(period / longest_substep - 1e-9)));
}

SimPlant::Hand SimPlant::hand_of(HandModel model) noexcept {
  switch (model) {
    case HandModel::spring:
      return {grip_stiffness, grip_damping, 0, 0, 0};
    case HandModel::arm:
      return {grip_stiffness, grip_damping, servo::arm_mass, arm_stiffness, arm_damping};
    case HandModel::none:
      break;
  }
  return {};
}

SimPlant::SimPlant(const PlantSettings& settings) noexcept
    : settings_(settings),
      hand_(hand_of(settings.hand)),
      step_(settings.period / std::max(1, settings.substeps)),
      friction_(settings.profile.friction * settings.friction_scale),
      line_({settings.period, settings.delay_ticks, settings.jitter, settings.lost_share,
             settings.profile.force_cap, settings.profile.bandwidth, settings.seed}),
      noise_source_(settings.seed ^ noise_seed),
      mass_(settings.profile.mass * Eigen::Matrix3d::Identity()),
      mass_axes_(Eigen::Matrix3d::Identity()),
      principal_masses_(Vector3::Constant(settings.profile.mass)) {
  settings_.substeps = std::max(1, settings.substeps);
  if (settings_.encoder_step < 0) settings_.encoder_step = settings_.profile.encoder_step;
  place(Vector3::Zero());
}

void SimPlant::place(const Vector3& position) noexcept {
  position_ = arm_position_ = target_ = position;
  velocity_.setZero();
  arm_velocity_.setZero();
  line_.reset();
  draw_noise();
  begin_tick();
}

void SimPlant::draw_noise() noexcept {
  if (!(settings_.noise > 0)) return;
  for (int axis = 0; axis < 3; ++axis) noise_[axis] = settings_.noise * noise_source_.normal();
}

Vector3 SimPlant::measured_position() const noexcept {
  const double size = settings_.encoder_step;
  const Vector3 seen = position_ + noise_;
  return size > 0 ? Vector3((seen / size).array().round().matrix() * size) : seen;
}

PlantEnergy SimPlant::energy() const noexcept {
  PlantEnergy energy;
  energy.tool = velocity_.dot(mass_ * velocity_) / 2;
  const Vector3 held = hand_.arm_mass > 0 ? arm_position_ : target_;
  energy.hand = hand_.grip_stiffness * (held - position_).squaredNorm() / 2;
  if (hand_.arm_mass > 0) {
    energy.hand += hand_.arm_mass * arm_velocity_.squaredNorm() / 2 +
                   hand_.stiffness * (target_ - arm_position_).squaredNorm() / 2;
  }
  return energy;
}

void SimPlant::begin_tick() noexcept {
  if (settings_.mass == MovingMass::constant) return;
  // Where the tool will be halfway through the tick: the mass is held at this value over the tick.
  const Vector3 halfway = position_ + velocity_ * (settings_.period / 2);
  mass_ = mass_at(settings_.mass, settings_.profile.mass, halfway);
  gyroscopic_ = gyroscopic_force(settings_.mass, settings_.profile.mass, halfway, velocity_);
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.compute(mass_);
  mass_axes_ = solver.eigenvectors();
  principal_masses_ = solver.eigenvalues();
}

/// The velocity v that solves A v + f v/|v| = `push`. A is the mass over the substep, plus `added`
/// (N s/m) on each axis. Coulomb friction is evaluated at the substep's end, so that it holds a
/// tool at rest and stops a moving one, without ever reversing it.
Vector3 SimPlant::rubbed(const Vector3& push, double added) const noexcept {
  const Vector3 along = mass_axes_.transpose() * push;
  const Eigen::Array3d weight = principal_masses_.array() / step_ + added;
  if (!(friction_ > 0)) return mass_axes_ * (along.array() / weight).matrix();
  const double size = along.norm();
  if (size <= friction_) return Vector3::Zero();
  // The speed s solves |along / (s weight + f)| = 1. The inverse of this expression is almost
  // linear in s, so that Newton's method converges at once, exactly so if the mass is the same in
  // all directions.
  double speed = 0;
  for (int round = 0; round < friction_rounds; ++round) {
    const Eigen::Array3d each = weight * speed + friction_;
    const Eigen::Array3d share = along.array() / each;
    const double norm = std::sqrt(share.square().sum());
    const double slope = (share.square() * weight / each).sum() / (norm * norm * norm);
    const double change = (1 - 1 / norm) / slope;
    speed += change;
    if (std::abs(change) <= friction_found * speed) break;
  }
  return mass_axes_ * (along.array() * speed / (weight * speed + friction_)).matrix();
}

void SimPlant::substep(const Vector3& actuator, const HandTarget& wanted,
                       PlantTick& tick) noexcept {
  const Moment before{position_, velocity_, arm_position_, arm_velocity_};
  const auto& [from, speed, arm_from, arm_speed] = before;
  const double damping = settings_.profile.damping;
  // The implicit midpoint rule: each force is taken at the mean of both ends of the substep. The
  // contribution of the unknown end goes to the left side, as `added` to the mass over the substep.
  const double grip = hand_.grip_stiffness * step_ / 4 + hand_.grip_damping / 2;
  Vector3 push = mass_ * speed / step_ + actuator + gyroscopic_ - damping / 2 * speed;
  double added = damping / 2 + grip;
  if (!(hand_.arm_mass > 0)) {
    push += hand_.grip_stiffness * (wanted.position - from) + hand_.grip_damping * wanted.velocity -
            grip * speed;
    velocity_ = rubbed(push, added);
  } else {
    // The end of the arm depends linearly on that of the tool, so it is eliminated.
    const double lead = hand_.stiffness * step_ / 4 + hand_.damping / 2;
    const double arm_weight = hand_.arm_mass / step_ + lead + grip;
    const Vector3 stretch = hand_.grip_stiffness * (arm_from - from) + grip * (arm_speed - speed);
    const Vector3 arm_push = hand_.arm_mass * arm_speed / step_ +
                             hand_.stiffness * (wanted.position - arm_from) +
                             hand_.damping * wanted.velocity - lead * arm_speed - stretch;
    push += stretch + grip / arm_weight * arm_push;
    added -= grip * grip / arm_weight;
    velocity_ = rubbed(push, added);
    arm_velocity_ = (arm_push + grip * velocity_) / arm_weight;
    arm_position_ += (arm_speed + arm_velocity_) * (step_ / 2);
  }
  position_ += (speed + velocity_) * (step_ / 2);
  const Vector3 rubbing = friction_ > 0
                              ? Vector3(push - mass_ * velocity_ / step_ - added * velocity_)
                              : Vector3(Vector3::Zero());
  account(before, actuator, rubbing, wanted, tick);
}

/// Adds the energy of a substep to the sums, with the same means that moved the tool.
void SimPlant::account(const Moment& before, const Vector3& actuator, const Vector3& rubbing,
                       const HandTarget& wanted, PlantTick& tick) const noexcept {
  const bool has_arm = hand_.arm_mass > 0;
  const Vector3 mean = (before.velocity + velocity_) / 2;
  const Vector3 middle = (before.position + position_) / 2;
  const Vector3 arm_mean =
      has_arm ? Vector3((before.arm_velocity + arm_velocity_) / 2) : wanted.velocity;
  const Vector3 arm_middle =
      has_arm ? Vector3((before.arm_position + arm_position_) / 2) : wanted.position;
  const Vector3 slip = arm_mean - mean;
  const Vector3 hand_force =
      hand_.grip_stiffness * (arm_middle - middle) + hand_.grip_damping * slip;
  tick.hand_force += hand_force;
  tick.actuator_force += actuator;
  tick.work += step_ * actuator.dot(mean);
  tick.hand_work += step_ * hand_force.dot(mean);
  tick.loss += step_ * (settings_.profile.damping * mean.squaredNorm() + rubbing.dot(mean));
  tick.hand_loss += step_ * hand_.grip_damping * slip.squaredNorm();
  if (has_arm) {
    const Vector3 arm_slip = wanted.velocity - arm_mean;
    const Vector3 lead =
        hand_.stiffness * (wanted.position - arm_middle) + hand_.damping * arm_slip;
    tick.hand_loss += step_ * hand_.damping * arm_slip.squaredNorm();
    tick.target_work += step_ * lead.dot(wanted.velocity);
  } else {
    tick.target_work += step_ * hand_force.dot(wanted.velocity);
  }
}

PlantTick SimPlant::step(const Vector3& commanded, const HandTarget& target) noexcept {
  PlantTick tick;
  begin_tick();
  line_.command(commanded);
  const double count = settings_.substeps;
  for (int i = 0; i < settings_.substeps; ++i) {
    const Vector3 actuator = line_.mean_force(i / count, (i + 1) / count);
    const double left = (count - i - 0.5) * step_;
    substep(actuator, {target.position - left * target.velocity, target.velocity}, tick);
  }
  tick.hand_force /= count;
  tick.actuator_force /= count;
  target_ = target.position;
  draw_noise();
  return tick;
}

PlantTick SimPlant::carry(const Vector3& commanded, const Vector3& to) noexcept {
  const Vector3 way = to - position_;
  const Vector3 speed = way / settings_.period;
  const double rubbing = way.isZero(0) ? 0 : friction_ / speed.norm();
  const Vector3 resisting = (settings_.profile.damping + rubbing) * speed;
  const double kinetic = energy().tool;
  const Vector3 momentum = mass_ * velocity_;
  PlantTick tick;
  line_.command(commanded);
  tick.actuator_force = line_.mean_force(0, 1);
  position_ = arm_position_ = target_ = to;
  velocity_ = arm_velocity_ = speed;
  begin_tick();
  tick.hand_force = (mass_ * speed - momentum) / settings_.period + resisting - tick.actuator_force;
  tick.work = tick.actuator_force.dot(way);
  tick.loss = resisting.dot(way);
  tick.hand_work = energy().tool - kinetic + tick.loss - tick.work;
  draw_noise();
  return tick;
}

}  // namespace spm::servo
