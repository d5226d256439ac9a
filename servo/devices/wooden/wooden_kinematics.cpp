// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/wooden/wooden_kinematics.hpp"

#include <cmath>
#include <numbers>

#include "servo/devices/wooden/wooden_reports.hpp"

namespace spm::servo {

namespace {

constexpr double turn = 2 * std::numbers::pi;
constexpr double standard_gravity = 9.80665;  // m/s^2

/// Turns of a joint for one turn of its motor.
double gear(const WoodenModel& model, std::size_t joint) noexcept {
  return model.capstan[joint] / model.body[joint];
}

/// Distance of the tool from the column's axis, m.
double radius_at(const WoodenModel& model, const Vector3& angles) noexcept {
  return model.length[1] * std::sin(angles[1]) + model.length[2] * std::sin(angles[2]);
}

Vector3 origin_of(const WoodenModel& model) noexcept {
  return {model.origin[0], model.origin[1], model.origin[2]};
}

}  // namespace

const WoodenModel* find_wooden_model(std::string_view name) noexcept {
  for (const WoodenModel& model : wooden_models) {
    if (model.name == name) return &model;
  }
  return nullptr;
}

std::string wooden_model_names() {
  std::string names;
  for (const WoodenModel& model : wooden_models) names.append(" ").append(model.name);
  return names;
}

Vector3 wooden_angles(const WoodenModel& model, const WoodenCalibration& calibration,
                      const std::array<std::int64_t, 3>& counts) noexcept {
  Vector3 angles;
  for (std::size_t i = 0; i < 3; ++i) {
    const double counted =
        calibration.count_signs[i] * static_cast<double>(counts[i]) + calibration.home[i];
    angles[static_cast<int>(i)] = turn * counted / model.counts_per_turn[i] * gear(model, i);
  }
  return angles;
}

Vector3 wooden_position(const WoodenModel& model, const Vector3& angles) noexcept {
  const double radius = radius_at(model, angles);
  const double height = model.length[0] + model.length[1] * std::cos(angles[1]) -
                        model.length[2] * std::cos(angles[2]);
  const Vector3 reached(std::cos(angles[0]) * radius, std::sin(angles[0]) * radius, height);
  return reached - origin_of(model);
}

std::optional<Vector3> wooden_inverse(const WoodenModel& model, const Vector3& position) noexcept {
  const Vector3 reached = position + origin_of(model);
  const double radius = std::hypot(reached.x(), reached.y());
  const double height = reached.z() - model.length[0];
  const double upper = model.length[1];
  const double lower = model.length[2];
  // The angle of the lower arm counts from below: seen from above, it is `elbow` larger than the
  // upper arm's.
  const double cosine =
      (radius * radius + height * height - upper * upper - lower * lower) / (2 * upper * lower);
  if (!(std::abs(cosine) <= 1)) return std::nullopt;
  const double elbow = std::acos(cosine);
  const double upper_angle = std::atan2(radius, height) -
                             std::atan2(lower * std::sin(elbow), upper + lower * std::cos(elbow));
  return Vector3(std::atan2(reached.y(), reached.x()), upper_angle,
                 std::numbers::pi - upper_angle - elbow);
}

Vector3 wooden_torques(const WoodenModel& model, const Vector3& angles,
                       const Vector3& force) noexcept {
  const double cosine = std::cos(angles[0]);
  const double sine = std::sin(angles[0]);
  const double outwards = cosine * force.x() + sine * force.y();
  const double sideways = cosine * force.y() - sine * force.x();
  return {radius_at(model, angles) * sideways,
          model.length[1] * (std::cos(angles[1]) * outwards - std::sin(angles[1]) * force.z()),
          model.length[2] * (std::cos(angles[2]) * outwards + std::sin(angles[2]) * force.z())};
}

double wooden_height_energy(const WoodenModel& model, const Vector3& angles) noexcept {
  const double upper_height = model.centre_of_mass[0] * std::cos(angles[1]);
  const double lower_height =
      model.length[1] * std::cos(angles[1]) - model.centre_of_mass[1] * std::cos(angles[2]);
  return standard_gravity * (model.mass[0] * upper_height + model.mass[1] * lower_height);
}

Vector3 wooden_gravity_torques(const WoodenModel& model, const Vector3& angles) noexcept {
  const double upper = model.mass[0] * model.centre_of_mass[0] + model.mass[1] * model.length[1];
  const double lower = model.mass[1] * model.centre_of_mass[1];
  return {0, -standard_gravity * upper * std::sin(angles[1]),
          standard_gravity * lower * std::sin(angles[2])};
}

Eigen::Quaterniond wooden_orientation(const WoodenModel& model,
                                      const WoodenCalibration& calibration, const Vector3& angles,
                                      const std::array<std::int16_t, 3>& gimbal) noexcept {
  if (!(model.gimbal_counts_per_turn > 0)) return Eigen::Quaterniond::Identity();
  std::array<double, 3> turned{};
  for (std::size_t i = 0; i < 3; ++i) {
    turned[i] = calibration.count_signs[i + 3] * turn * gimbal[i] / model.gimbal_counts_per_turn;
  }
  const Eigen::Quaterniond all = Eigen::AngleAxisd(angles[0], Vector3::UnitZ()) *
                                 Eigen::AngleAxisd(turn / 4 - angles[2], Vector3::UnitY()) *
                                 Eigen::AngleAxisd(turned[0], Vector3::UnitX()) *
                                 Eigen::AngleAxisd(turned[1], Vector3::UnitY()) *
                                 Eigen::AngleAxisd(turned[2], Vector3::UnitX());
  return all.normalized();
}

std::array<std::int16_t, 3> wooden_currents(const WoodenModel& model,
                                            const WoodenCalibration& calibration,
                                            const Vector3& torques, double limit) noexcept {
  std::array<std::int16_t, 3> currents{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double current = calibration.motor_signs[i] * torques[static_cast<int>(i)] *
                           gear(model, i) / model.torque_constant[i];
    currents[i] = limited_milliamperes(current, limit);
  }
  return currents;
}

}  // namespace spm::servo
