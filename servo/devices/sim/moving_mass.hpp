// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string_view>

#include "common/base/vector.hpp"

namespace spm::servo {

/// What moves with a simulated tool.
enum class MovingMass : std::uint8_t {
  constant,    ///< the profile's mass, the same in every pose and direction
  falcon,      ///< the Falcon's three legs and its grip
  serial_arm,  ///< a WoodenHaptics arm
};

/// The mass felt at the tool, kg, symmetric and positive definite. It is scaled by an assumed
/// handle so that, with the tool at the device's origin, its mean over the directions is `mass`
/// (kg, above 0). `position` in m, world frame; outside the range for which the mass is known, it
/// is the one at the edge of the range.
[[nodiscard]] Eigen::Matrix3d mass_at(MovingMass kind, double mass,
                                      const Vector3& position) noexcept;

/// The forces (N, on the tool) with which a mass that changes with the pose resists its own motion:
/// minus the centrifugal and Coriolis terms of Lagrange's equations, so that energy is conserved.
[[nodiscard]] Vector3 gyroscopic_force(MovingMass kind, double mass, const Vector3& position,
                                       const Vector3& velocity) noexcept;

/// The kinematics that are known for a device profile, or nothing.
[[nodiscard]] std::optional<MovingMass> moving_mass_of(std::string_view profile) noexcept;

}  // namespace spm::servo
