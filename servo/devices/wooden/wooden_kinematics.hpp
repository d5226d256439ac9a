// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/vector.hpp"

namespace spm::servo {

/// One construction of the WoodenHaptics family with a serial arm: yaw A, upper arm B, lower arm C.
/// B and C belong to a parallel linkage, so that both angles are absolute.
struct WoodenModel {
  std::string_view name;
  std::array<double, 3> capstan;          ///< m, diameter of each motor's drum
  std::array<double, 3> body;             ///< m, diameter of the body that it turns
  std::array<double, 3> length;           ///< m, column, upper arm, lower arm
  std::array<double, 3> origin;           ///< m, subtracted from the position, device frame
  std::array<double, 3> torque_constant;  ///< N m / A of each motor
  double full_scale_current;              ///< A, of the drives at full scale
  std::array<double, 3> counts_per_turn;  ///< of encoders A to C, at the motor
  double gimbal_counts_per_turn;          ///< of encoders D to F; 0: there are none
  /// +1 or -1: each joint relative to its motor, which its encoder sits on
  std::array<double, 3> direction;
  /// counts in the joint's positive direction, when the counters are 0
  std::array<double, 3> home;
  double max_force;                      ///< N
  std::array<double, 2> mass;            ///< kg, upper and lower arm
  std::array<double, 2> centre_of_mass;  ///< m from its joint
};

/// As public hosts list them; none was measured here [U].
inline constexpr std::array<WoodenModel, 5> wooden_models{{
    {"woodenhaptics2015",
     {0.010, 0.010, 0.010},
     {0.160, 0.120, 0.120},
     {0.080, 0.205, 0.245},
     {0.220, 0, 0.080},
     {0.0259, 0.0259, 0.0259},
     6,
     {2000, 2000, 2000},
     0,
     {1, 1, 1},
     {0, 0, 6000},
     5,
     {0.17, 0.11},
     {0.051, 0.091}},
    {"woodenhaptics2016",
     {0.010, 0.010, 0.010},
     {0.160, 0.120, 0.120},
     {0.080, 0.205, 0.245},
     {0.220, 0, 0.080},
     {0.0259, 0.0259, 0.0259},
     3,
     {2000, 2000, 2000},
     0,
     {-1, 1, -1},
     {0, 0, 6000},
     5,
     {0.17, 0.11},
     {0.051, 0.091}},
    {"woody2019",
     {0.010, 0.010, 0.010},
     {0.160, 0.120, 0.120},
     {0.080, 0.205, 0.245},
     {0.220, 0, 0.080},
     {0.321, 0.0603, 0.0603},
     3,
     {2000, 2000, 2000},
     0,
     {1, 1, 1},
     {0, 0, 6000},
     5,
     {0.17, 0.11},
     {0.051, 0.091}},
    {"aluhaptics",
     {0.0138, 0.0098, 0.0098},
     {0.116, 0.076, 0.076},
     {0.111, 0.140, 0.111},
     {0.140, 0, 0},
     {0.0259, 0.0259, 0.0259},
     3,
     {2000, 2000, 2000},
     0,
     {1, 1, 1},
     {0, 3878, 0},  // the upper arm lies level, a quarter turn on
     5,
     {0.17, 0.11},
     {0.051, 0.091}},
    {"vintage",
     {0.013, 0.010, 0.010},
     {0.117, 0.077, 0.077},
     {0, 0.138, 0.112},
     {0.138, 0, -0.097},
     {0.0234, 0.0234, 0.0234},
     3,
     {4000, 4000, 4000},
     2000,
     {1, 1, 1},
     {0, 7700, 0},
     5,
     {0.17, 0.11},
     {0.051, 0.091}},
}};

/// The model of that name, or null.
[[nodiscard]] const WoodenModel* find_wooden_model(std::string_view name) noexcept;
/// The names of all models, each after a blank, for messages.
[[nodiscard]] std::string wooden_model_names();

/// How one arm counts and is wired, which depends on its firmware and its builder. Therefore each
/// arm needs a check: move a joint and see which way it goes.
struct WoodenCalibration {
  /// +1 or -1: joint relative to counter, A to F
  std::array<double, 6> count_signs{1, 1, 1, 1, 1, 1};
  std::array<double, 3> motor_signs{1, 1, 1};  ///< +1 or -1: current relative to torque
  std::array<double, 3> home{0, 0, 0};         ///< counts, as WoodenModel::home
};

/// From the device's frame (x out of the base along the arm at rest, y to its left, z up) to the
/// world's (x to the right, y up, z towards the user). Assumed [U]: the base stands opposite the
/// user, and the arm points towards the user. No source says how it stands. For an arm that stands
/// otherwise, rotate the scene's workspace.
inline const Eigen::Matrix3d wooden_to_world =
    (Eigen::Matrix3d() << 0, 1, 0, 0, 0, 1, 1, 0, 0).finished();

/// Angles of the joints A, B, C in rad, from unwrapped counters.
[[nodiscard]] Vector3 wooden_angles(const WoodenModel& model, const WoodenCalibration& calibration,
                                    const std::array<std::int64_t, 3>& counts) noexcept;

/// Position of the tool, m, device frame.
[[nodiscard]] Vector3 wooden_position(const WoodenModel& model, const Vector3& angles) noexcept;

/// Angles that bring the tool to a position, m, device frame; nothing if the arm does not reach it.
/// Of the two solutions it gives the one with the lower arm's elbow up and the tool in front of the
/// column.
[[nodiscard]] std::optional<Vector3> wooden_inverse(const WoodenModel& model,
                                                    const Vector3& position) noexcept;

/// Torques of the joints, N m, that give a force of the tool, N, device frame (J^T F).
[[nodiscard]] Vector3 wooden_torques(const WoodenModel& model, const Vector3& angles,
                                     const Vector3& force) noexcept;

/// Torques of the joints, N m, that hold the arm's weight: the gradient of the potential energy of
/// its two masses. The term in public hosts, which is off in all their tables, has a different sign
/// and angle for B; neither was tried on a device [U].
[[nodiscard]] Vector3 wooden_gravity_torques(const WoodenModel& model,
                                             const Vector3& angles) noexcept;

/// Orientation of the handle, device frame; identity if the model has no encoders D to F. `gimbal`:
/// counters D to F, with the button removed from D. The order of the rotations is that of one
/// variant [U].
[[nodiscard]] Eigen::Quaterniond wooden_orientation(
    const WoodenModel& model, const WoodenCalibration& calibration, const Vector3& angles,
    const std::array<std::int16_t, 3>& gimbal) noexcept;

/// Currents of the motors, mA, for torques of the joints, N m. Each is limited to `limit`, A.
[[nodiscard]] std::array<std::int16_t, 3> wooden_currents(const WoodenModel& model,
                                                          const WoodenCalibration& calibration,
                                                          const Vector3& torques,
                                                          double limit) noexcept;

}  // namespace spm::servo
