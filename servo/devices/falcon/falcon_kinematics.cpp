// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/falcon/falcon_kinematics.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "servo/devices/falcon/falcon_packet.hpp"

namespace spm::servo {

namespace {

using std::numbers::sqrt2;
using std::numbers::sqrt3;

// Geometry, m: R. E. Stamper's manipulator of three legs, with the lengths that public drivers use.
constexpr double thigh = 0.060;
constexpr double shin = 0.1025;             // the long sides of its parallelogram
constexpr double shin_ends = 2 * 0.01125;   // its two short sides, at the knee and at the grip
constexpr double grip_outward = 0.01443;    // from the middle of the grip to the end of a shin
constexpr double grip_sideways = -0.025;    // the same, along the thigh's axis
constexpr double base_outward = 0.0400;     // from the middle of the base to the axis of a thigh
constexpr double base_sideways = -0.02309;  // the same, along that axis

/// The direction of a leg, seen from the front.
struct Azimuth {
  double cosine;
  double sine;
};

// 105, -15 and -135 degrees, exactly rounded.
constexpr double cos_15 = sqrt2 * (sqrt3 + 1) / 4, sin_15 = sqrt2 * (sqrt3 - 1) / 4;
constexpr std::array<Azimuth, 3> azimuths{
    {{-sin_15, cos_15}, {cos_15, -sin_15}, {-sqrt2 / 2, -sqrt2 / 2}}};

// The encoder has 320 slots a turn of a motor, counted four times. The motor's drum drives a sector
// of the thigh.
constexpr double counts_a_turn = 320 * 4;
constexpr double drum = 14.25, sector = 110;                                          // mm
constexpr double count_angle = drum / sector * 2 * std::numbers::pi / counts_a_turn;  // rad

// Found by trial in public drivers, unverified here: more torque outwards needs a command further
// below zero.
constexpr double motor_command_scale = -10000;  // per N m

constexpr double found_within = 1e-9;  // m; the encoders' step is 37 um
constexpr double longest_step = 0.03;  // m; beyond that the tangent says nothing

/// Where the grip's end of a leg is, in the plane in which the leg's thigh turns.
struct Leg {
  double outward;      ///< m, from the thigh's axis
  double forward;      ///< m
  double shin_cosine;  ///< of the shin's tilt out of the plane
  double shin_sine;
  double reach;  ///< m, of the shin and its ends, in the plane
};

Leg leg_at(const Vector3& position, const Azimuth& azimuth) noexcept {
  const double x = position.x(), y = position.y();
  const double sideways = azimuth.cosine * y - azimuth.sine * x - base_sideways + grip_sideways;
  Leg leg{};
  leg.outward = azimuth.cosine * x + azimuth.sine * y - base_outward + grip_outward;
  leg.forward = position.z() + falcon_centre_distance;
  leg.shin_cosine = sideways / shin;
  leg.shin_sine = std::sqrt(1 - leg.shin_cosine * leg.shin_cosine);  // NaN if out of its reach
  leg.reach = shin_ends + shin * leg.shin_sine;
  return leg;
}

/// Converts a gradient over a leg's own axes to one over x, y and z.
Eigen::RowVector3d turned(const Azimuth& azimuth, double outward, double sideways,
                          double forward) noexcept {
  return {azimuth.cosine * outward - azimuth.sine * sideways,
          azimuth.sine * outward + azimuth.cosine * sideways, forward};
}

/// How far the legs are from closing, m^2, and how that changes with the position.
struct Closure {
  Vector3 gap;
  Eigen::Matrix3d gradient;
  bool knees_outward;  ///< whether the knees bend outward, as in every Falcon
};

Closure closure_at(const Vector3& position, const Vector3& angles) noexcept {
  Closure closure{Vector3::Zero(), Eigen::Matrix3d::Zero(), true};
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Azimuth& azimuth = azimuths[static_cast<std::size_t>(i)];
    const Leg leg = leg_at(position, azimuth);
    const double cosine = std::cos(angles[i]), sine = std::sin(angles[i]);
    const double outward = leg.outward - thigh * cosine;
    const double forward = leg.forward - thigh * sine;
    closure.gap[i] = outward * outward + forward * forward - leg.reach * leg.reach;
    closure.gradient.row(i) =
        turned(azimuth, 2 * outward, 2 * leg.reach * leg.shin_cosine / leg.shin_sine, 2 * forward);
    closure.knees_outward = closure.knees_outward && cosine * forward - sine * outward > 0;
  }
  return closure;
}

}  // namespace

Vector3 falcon_angles(const std::array<std::int16_t, 3>& counts, double home_angle) noexcept {
  return Vector3::Constant(home_angle) + count_angle * Vector3(counts[0], counts[1], counts[2]);
}

std::optional<Vector3> falcon_inverse(const Vector3& position) noexcept {
  Vector3 angles;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Leg leg = leg_at(position, azimuths[static_cast<std::size_t>(i)]);
    const double distance = std::hypot(leg.outward, leg.forward);
    const double along =
        (distance * distance + thigh * thigh - leg.reach * leg.reach) / (2 * thigh);
    if (!(std::abs(along) <= distance)) return std::nullopt;
    angles[i] = std::atan2(leg.forward, leg.outward) - std::acos(along / distance);
  }
  return angles;
}

Eigen::Matrix3d falcon_jacobian(const Vector3& position, const Vector3& angles) noexcept {
  // From the closure of the legs, as its numeric derivative confirms. Public drivers have another
  // entry for z, which is wrong by a quarter.
  Eigen::Matrix3d jacobian;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Azimuth& azimuth = azimuths[static_cast<std::size_t>(i)];
    const Leg leg = leg_at(position, azimuth);
    const double cosine = std::cos(angles[i]), sine = std::sin(angles[i]);
    const double knee_cosine = (leg.outward - thigh * cosine) / leg.reach;
    const double knee_sine = (leg.forward - thigh * sine) / leg.reach;
    const double lever = thigh * leg.shin_sine * (knee_sine * cosine - knee_cosine * sine);
    jacobian.row(i) =
        turned(azimuth, knee_cosine * leg.shin_sine, leg.shin_cosine, knee_sine * leg.shin_sine) /
        lever;
  }
  return jacobian;
}

FalconPose falcon_forward(const Vector3& angles, const Vector3& start) noexcept {
  FalconPose pose;
  pose.position = start;
  while (pose.steps < falcon_max_steps) {
    const Closure closure = closure_at(pose.position, angles);
    Vector3 step = -(closure.gradient.inverse() * closure.gap);
    const double length = step.norm();
    if (!std::isfinite(length)) return pose;
    if (length > longest_step) step *= longest_step / length;
    pose.position += step;
    ++pose.steps;
    if (length < found_within) {
      pose.search = closure.knees_outward ? FalconSearch::found : FalconSearch::other_branch;
      return pose;
    }
  }
  return pose;
}

std::optional<Vector3> falcon_torques(const Vector3& position, const Vector3& angles,
                                      const Vector3& force) noexcept {
  // The power at the thighs equals that at the hand.
  const Vector3 torques = falcon_jacobian(position, angles).transpose().inverse() * force;
  if (!torques.allFinite()) return std::nullopt;
  return torques;
}

std::array<std::int16_t, 3> falcon_motors(const Vector3& torques) noexcept {
  std::array<std::int16_t, 3> motors{};
  Vector3 commands = motor_command_scale * torques;
  if (!commands.allFinite()) return motors;
  const double largest = commands.cwiseAbs().maxCoeff();
  if (largest > falcon_motor_limit) commands *= falcon_motor_limit / largest;
  for (Eigen::Index i = 0; i < 3; ++i) {
    motors[static_cast<std::size_t>(i)] = static_cast<std::int16_t>(std::lround(commands[i]));
  }
  return motors;
}

}  // namespace spm::servo
