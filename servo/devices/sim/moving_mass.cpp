// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/moving_mass.hpp"

#include <algorithm>

#include "servo/devices/falcon/falcon_kinematics.hpp"
#include "servo/devices/wooden/wooden_kinematics.hpp"

namespace spm::servo {

namespace {

/// m, about the origin: every pose within it can be reached, and no leg is near its end.
constexpr double falcon_reach = 0.04;
constexpr double wooden_reach = 0.08;

/// Fraction of the Falcon's mass that moves as the grip does; the rest turns with the thighs.
/// Assumed.
constexpr double falcon_grip_share = 0.4;

/// kg m^2, of a motor's rotor and drum. Assumed from motors of that size.
constexpr double wooden_rotor = 1.4e-5;

constexpr double gradient_step = 1e-4;  // m

Vector3 within(const Vector3& position, double reach) noexcept {
  const double distance = position.norm();
  return distance > reach ? Vector3(position * (reach / distance)) : position;
}

/// J^T J of the thighs' rotation with respect to the tool's motion, 1/m^2: the mass of thighs of 1
/// kg m^2.
Eigen::Matrix3d falcon_thighs(const Vector3& position) noexcept {
  const auto angles = falcon_inverse(position);
  if (!angles) return Eigen::Matrix3d::Identity();  // never within the reach
  const Eigen::Matrix3d jacobian = falcon_jacobian(position, *angles);
  return jacobian.transpose() * jacobian;
}

/// Transposed Jacobian of a point on an arm, m: from forces at the point to torques of the joints.
Eigen::Matrix3d transposed_jacobian(const WoodenModel& model, const Vector3& angles) noexcept {
  Eigen::Matrix3d transposed;
  for (int axis = 0; axis < 3; ++axis) {
    transposed.col(axis) = wooden_torques(model, angles, Vector3::Unit(axis));
  }
  return transposed;
}

/// Inertia of the joints, kg m^2: the two arms as points at their centres of mass, and the rotors.
Eigen::Matrix3d wooden_inertia(const WoodenModel& model, const Vector3& angles) noexcept {
  WoodenModel upper = model;
  upper.length = {model.length[0], model.centre_of_mass[0], 0};
  WoodenModel lower = model;
  lower.length[2] = model.centre_of_mass[1];
  const Eigen::Matrix3d of_upper = transposed_jacobian(upper, angles);
  const Eigen::Matrix3d of_lower = transposed_jacobian(lower, angles);
  Eigen::Matrix3d inertia = model.mass[0] * of_upper * of_upper.transpose() +
                            model.mass[1] * of_lower * of_lower.transpose();
  for (std::size_t joint = 0; joint < 3; ++joint) {
    const double gear = model.body[joint] / model.capstan[joint];
    inertia(static_cast<int>(joint), static_cast<int>(joint)) += wooden_rotor * gear * gear;
  }
  return inertia;
}

/// The mass of the arms and rotors at the tool, kg, world frame.
Eigen::Matrix3d wooden_arms(const Vector3& position) noexcept {
  const WoodenModel& model = wooden_models[0];
  const auto angles = wooden_inverse(model, wooden_to_world.transpose() * position);
  if (!angles) return Eigen::Matrix3d::Identity();  // never within the reach
  const Eigen::Matrix3d to_joints = transposed_jacobian(model, *angles).transpose().inverse();
  const Eigen::Matrix3d mass = to_joints.transpose() * wooden_inertia(model, *angles) * to_joints;
  return wooden_to_world * mass * wooden_to_world.transpose();
}

Eigen::Matrix3d falcon_mass(double mass, const Vector3& position) noexcept {
  static const double at_centre = falcon_thighs(Vector3::Zero()).trace() / 3;
  return mass * (falcon_grip_share * Eigen::Matrix3d::Identity() +
                 (1 - falcon_grip_share) / at_centre * falcon_thighs(position));
}

/// The arms have the model's masses; the handle has the rest of the profile's mass, at least a
/// fifth of it.
Eigen::Matrix3d serial_mass(double mass, const Vector3& position) noexcept {
  static const double at_centre = wooden_arms(Vector3::Zero()).trace() / 3;
  const double handle = std::max(mass - at_centre, mass / 5);
  const double scale = (mass - handle) / at_centre;
  return handle * Eigen::Matrix3d::Identity() + scale * wooden_arms(position);
}

}  // namespace

Eigen::Matrix3d mass_at(MovingMass kind, double mass, const Vector3& position) noexcept {
  Eigen::Matrix3d all = mass * Eigen::Matrix3d::Identity();
  if (kind == MovingMass::falcon) all = falcon_mass(mass, within(position, falcon_reach));
  if (kind == MovingMass::serial_arm) all = serial_mass(mass, within(position, wooden_reach));
  return (all + all.transpose()) / 2;
}

Vector3 gyroscopic_force(MovingMass kind, double mass, const Vector3& position,
                         const Vector3& velocity) noexcept {
  if (kind == MovingMass::constant || velocity.isZero(0)) return Vector3::Zero();
  Eigen::Matrix3d rate = Eigen::Matrix3d::Zero();
  Vector3 slope;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 aside = gradient_step * Vector3::Unit(axis);
    const Eigen::Matrix3d change =
        (mass_at(kind, mass, position + aside) - mass_at(kind, mass, position - aside)) /
        (2 * gradient_step);
    rate += change * velocity[axis];
    slope[axis] = velocity.dot(change * velocity);
  }
  return slope / 2 - rate * velocity;
}

std::optional<MovingMass> moving_mass_of(std::string_view profile) noexcept {
  if (profile == "falcon") return MovingMass::falcon;
  if (profile == "wooden") return MovingMass::serial_arm;
  return std::nullopt;
}

}  // namespace spm::servo
