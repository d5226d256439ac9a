// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/sixdof_plant.hpp"

#include <cmath>

namespace spm::servo {

namespace {

/// Of the source of noise, so that it is not the luck of the actuators.
constexpr std::uint64_t pose_noise_seed = 0x6E6F697365;

/// Coulomb friction as the largest momentum it can take in a substep.
Vector3 rubbed(const Vector3& momentum, double largest) noexcept {
  const double size = momentum.norm();
  if (size <= largest) return Vector3::Zero();
  return momentum * (1 - largest / size);
}

Vector3 limited(const Vector3& vector, double cap) noexcept {
  const double size = vector.norm();
  return size > cap ? Vector3(vector * (cap / size)) : vector;
}

ActuatorSettings line_of(const SixdofSettings& settings, double cap) noexcept {
  ActuatorSettings line;
  line.period = settings.period;
  line.delay_ticks = settings.delay_ticks;
  line.force_cap = cap;
  line.bandwidth = settings.profile.bandwidth;
  line.jitter = settings.jitter;
  line.lost_share = settings.lost_share;
  // The same luck for force and torque, which travel together.
  line.seed = settings.seed;
  return line;
}

Vector3 rounded(const Vector3& vector, double step) noexcept {
  if (!(step > 0)) return vector;
  return (vector / step).array().round().matrix() * step;
}

}  // namespace

Eigen::Quaterniond orientation_of(const Vector3& turn) noexcept {
  const double angle = turn.norm();
  if (angle == 0) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle));
}

SixdofPlant::SixdofPlant(const SixdofSettings& settings) noexcept
    : settings_(settings),
      step_(settings.period / settings.substeps),
      mass_(settings.profile.mass * settings.mass_scale),
      inertia_(mass_ * settings.gyration.array().square().matrix()),
      grip_(settings.hand == HandModel::none ? 0 : settings.grip_share),
      encoder_step_(settings.encoder_step < 0 ? settings.profile.encoder_step
                                              : settings.encoder_step),
      noise_source_(settings.seed ^ pose_noise_seed),
      forces_(line_of(settings, settings.profile.force_cap)),
      torques_(line_of(settings, torque_cap())) {}

void SixdofPlant::place(const Eigen::Isometry3d& pose) noexcept {
  pose_ = pose;
  orientation_ = start_ = Eigen::Quaterniond(pose.linear()).normalized();
  velocity_.setZero();
  momentum_.setZero();
  arm_ = pose.translation();
  arm_velocity_.setZero();
  actuator_ = {};
  forces_.reset();
  torques_.reset();
  draw_noise();
}

void SixdofPlant::draw_noise() noexcept {
  if (!(settings_.noise > 0)) return;
  for (double& along : noise_) along = settings_.noise * noise_source_.normal();
  for (double& about : turn_noise_) {
    about = settings_.noise / settings_.encoder_lever * noise_source_.normal();
  }
}

Vector3 SixdofPlant::body_rates() const noexcept {
  return (orientation_.conjugate() * momentum_).cwiseQuotient(inertia_);
}

void SixdofPlant::set_motion(const Vector3& velocity, const Vector3& angular_velocity) noexcept {
  velocity_ = velocity;
  momentum_ =
      orientation_ * inertia_.cwiseProduct(orientation_.conjugate() * angular_velocity).eval();
}

Vector3 SixdofPlant::angular_velocity() const noexcept { return orientation_ * body_rates(); }

double SixdofPlant::kinetic_energy() const noexcept {
  const Vector3 rates = body_rates();
  return mass_ * velocity_.squaredNorm() / 2 + rates.cwiseProduct(inertia_).dot(rates) / 2;
}

double SixdofPlant::turn_step() const noexcept { return encoder_step_ / settings_.encoder_lever; }

double SixdofPlant::torque_cap() const noexcept {
  return settings_.profile.force_cap * settings_.torque_lever;
}

Eigen::Isometry3d SixdofPlant::measured_pose() const noexcept {
  Eigen::Isometry3d measured = Eigen::Isometry3d::Identity();
  measured.translation() = rounded(pose_.translation() + noise_, encoder_step_);
  const Vector3 turn = rounded(turn_between(start_, orientation_) + turn_noise_, turn_step());
  measured.linear() = (orientation_of(turn) * start_).normalized().toRotationMatrix();
  return measured;
}

Wrench SixdofPlant::reachable(const Wrench& commanded) const noexcept {
  return {limited(commanded.force, settings_.profile.force_cap),
          limited(commanded.torque, torque_cap())};
}

void SixdofPlant::drift(double seconds) noexcept {
  pose_.translation() += seconds * velocity_;
  arm_ += seconds * arm_velocity_;
  // The rates of a freely turning body are those of its middle orientation, to second order.
  const Eigen::Quaterniond before = orientation_;
  orientation_ = before * orientation_of(body_rates() * (seconds / 2));
  orientation_ = (before * orientation_of(body_rates() * seconds)).normalized();
}

void SixdofPlant::kick_place(const Vector3& wanted, const Vector3& speed,
                             SixdofTick& tick) noexcept {
  const SixdofSettings& s = settings_;
  const bool has_arm = s.hand == HandModel::arm;
  const double grip = grip_ * grip_stiffness;
  const double damper = grip_ * grip_damping;
  const double share = 1.0 / s.substeps;
  const Vector3 held = has_arm ? arm_ : wanted;
  const Vector3 spring = grip * (held - pose_.translation());
  const Vector3 outer = actuator_.force + s.weight + spring;
  // Mean velocities over the substep, of the handle and of what holds it: implicit in the dampers.
  const double own = 2 * mass_ + step_ * (s.profile.damping + damper);
  const Vector3 push = 2 * mass_ * velocity_ + step_ * outer;
  Vector3 mean, held_mean = speed;
  if (has_arm) {
    const double arm = 2 * arm_mass + step_ * (arm_damping + damper);
    const double between = step_ * damper;
    const Vector3 arm_push =
        2 * arm_mass * arm_velocity_ +
        step_ * (arm_stiffness * (wanted - arm_) + arm_damping * speed - spring);
    const double determinant = own * arm - between * between;
    mean = (arm * push + between * arm_push) / determinant;
    held_mean = (own * arm_push + between * push) / determinant;
    arm_velocity_ = 2 * held_mean - arm_velocity_;
  } else {
    mean = (push + step_ * damper * speed) / own;
  }
  const Vector3 before = velocity_;
  const Vector3 unrubbed = mass_ * (2 * mean - before);
  const Vector3 momentum = rubbed(unrubbed, s.friction_scale * s.profile.friction * step_);
  velocity_ = momentum / mass_;
  const Vector3 moved = (before + velocity_) / 2;
  const Vector3 hand = spring + damper * (held_mean - mean);
  tick.hand.force += share * hand;
  tick.actuator.force += share * actuator_.force;
  tick.work += step_ * actuator_.force.dot(moved);
  tick.hand_work += step_ * hand.dot(moved);
  tick.weight_work += step_ * s.weight.dot(moved);
  tick.dissipated += (step_ * s.profile.damping * mean + unrubbed - momentum).dot(moved);
}

void SixdofPlant::kick_turn(const Eigen::Quaterniond& wanted, const Vector3& rate,
                            SixdofTick& tick) noexcept {
  const SixdofSettings& s = settings_;
  const double share = 1.0 / s.substeps;
  const Eigen::Quaterniond to_body = orientation_.conjugate();
  const double damper = grip_ * s.grip_turning_damping;
  const Vector3 spring =
      to_body * (grip_ * s.grip_turning * turn_between(orientation_, wanted)).eval();
  const Vector3 actuator = to_body * actuator_.torque;
  const Vector3 wanted_rate = to_body * rate;
  const double radius2 = inertia_.mean() / mass_;
  const double damping = s.profile.damping * radius2;
  const Vector3 before = body_rates();
  const Vector3 mean =
      (2 * inertia_.cwiseProduct(before) + step_ * (actuator + spring + damper * wanted_rate))
          .cwiseQuotient(2 * inertia_ + Vector3::Constant(step_ * (damping + damper)));
  const Vector3 unrubbed = inertia_.cwiseProduct(2 * mean - before);
  const Vector3 momentum =
      rubbed(unrubbed, s.friction_scale * s.profile.friction * std::sqrt(radius2) * step_);
  const Vector3 turned = (before + momentum.cwiseQuotient(inertia_)) / 2;
  momentum_ = orientation_ * momentum;
  const Vector3 hand = spring + damper * (wanted_rate - mean);
  tick.hand.torque += share * (orientation_ * hand);
  tick.actuator.torque += share * actuator_.torque;
  tick.work += step_ * actuator.dot(turned);
  tick.hand_work += step_ * hand.dot(turned);
  tick.dissipated += (step_ * damping * mean + unrubbed - momentum).dot(turned);
}

void SixdofPlant::kick(const SixdofTarget& target, double before_end, SixdofTick& tick) noexcept {
  kick_place(target.position - before_end * target.velocity, target.velocity, tick);
  kick_turn(orientation_of(-before_end * target.angular_velocity) * target.orientation,
            target.angular_velocity, tick);
}

SixdofTick SixdofPlant::step(const Wrench& commanded, const SixdofTarget& target) noexcept {
  SixdofTick tick;
  forces_.command(commanded.force);
  torques_.command(commanded.torque);
  for (int substep = 0; substep < settings_.substeps; ++substep) {
    const double begin = static_cast<double>(substep) / settings_.substeps;
    const double end = static_cast<double>(substep + 1) / settings_.substeps;
    actuator_ = {forces_.mean_force(begin, end), torques_.mean_force(begin, end)};
    drift(step_ / 2);
    kick(target, (settings_.substeps - substep - 0.5) * step_, tick);
    drift(step_ / 2);
  }
  pose_.linear() = orientation_.toRotationMatrix();
  draw_noise();
  return tick;
}

}  // namespace spm::servo
