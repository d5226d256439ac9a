// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <numbers>
#include <optional>

#include "common/base/vector.hpp"

namespace spm::servo {

// Positions are those of the hand: metres, x to the right, y up, z towards the user, from the
// device's centre. Angles are those of the three thighs, rad, in the order of the legs: top, right,
// left.

/// m, from the base of the legs to the point that is used as the device's centre. This is a choice:
/// the workspace extends about 50 mm around 0.11 to 0.13 m, and the encoders' step is known here.
inline constexpr double falcon_centre_distance = 0.12;

/// rad, of a thigh when its encoder counts zero. Public drivers call it approximate: it may be
/// calibrated for each device.
inline constexpr double falcon_home_angle = 35 * std::numbers::pi / 180;

/// Thigh angles for encoder counts, rad.
[[nodiscard]] Vector3 falcon_angles(const std::array<std::int16_t, 3>& counts,
                                    double home_angle = falcon_home_angle) noexcept;

/// Thigh angles at a position; none if the legs do not reach it.
[[nodiscard]] std::optional<Vector3> falcon_inverse(const Vector3& position) noexcept;

/// How the thighs turn as the hand moves, rad/m: row i is that of leg i. Position and angles must
/// belong together. Not finite if a leg is stretched out.
[[nodiscard]] Eigen::Matrix3d falcon_jacobian(const Vector3& position,
                                              const Vector3& angles) noexcept;

/// How a search for a position ended.
enum class FalconSearch : std::uint8_t {
  found,
  not_found,     ///< no position near the start has these angles
  other_branch,  ///< the angles match, but with a knee bent the other way, as in no Falcon
};

struct FalconPose {
  FalconSearch search = FalconSearch::not_found;
  Vector3 position = Vector3::Zero();  ///< valid if found
  int steps = 0;                       ///< number of Newton steps
};

/// The position at given angles, to a nanometre, searched from `start`. There is no closed form;
/// the last position is the best start. Takes at most falcon_max_steps steps.
[[nodiscard]] FalconPose falcon_forward(const Vector3& angles, const Vector3& start) noexcept;
inline constexpr int falcon_max_steps = 20;

/// Torques at the thighs, N m, that push the hand with a force, N. None if a leg is stretched out,
/// because then no torque gives that force.
[[nodiscard]] std::optional<Vector3> falcon_torques(const Vector3& position, const Vector3& angles,
                                                    const Vector3& force) noexcept;

/// Motor commands for torques, N m. If one is beyond its limit, all three are scaled together, so
/// that the force keeps its direction. Zero if a torque is not finite.
[[nodiscard]] std::array<std::int16_t, 3> falcon_motors(const Vector3& torques) noexcept;

}  // namespace spm::servo
