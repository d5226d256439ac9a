// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

#include "common/base/vector.hpp"

namespace spm {

enum class HandEffectKind : std::uint8_t {
  spring,   ///< pulls towards a point
  viscous,  ///< brakes the tool
  magnet,   ///< pulls from outside towards an object's surface
  detents,  ///< pulls along an axis to the nearest of places at a spacing
};

/// A simple force on a hand beside that of the objects. The pulls are gradients of a potential, so
/// that no way through them gives energy while nobody moves them.
struct HandEffect {
  HandEffectKind kind = HandEffectKind::spring;
  Vector3 point = Vector3::Zero();  ///< m: of the spring; one of the detents
  Vector3 axis = Vector3::Zero();   ///< unit, of the detents
  double stiffness = 0;             ///< N/m, 0 or more
  /// N s/m, 0 or more. Beside a pull it brakes in the pull's directions, and fades out where the
  /// pull has ended.
  double damping = 0;
  double most_force = std::numeric_limits<double>::infinity();  ///< N, 0 or more
  /// m, above 0. Of spring and magnet: no pull from there on. Of detents: how far from the point,
  /// along the axis, the last of them may be.
  double range = std::numeric_limits<double>::infinity();
  double spacing = 0;  ///< m, above 0, of the detents
};

/// A surface as seen from a point that is near.
struct NearSurface {
  double distance = 0;               ///< m, negative inside
  Vector3 normal = Vector3::Zero();  ///< unit, outward; zero where nothing is known
  double reach = 0;                  ///< m: how far outside the distance is known
};

/// The pull, N, towards something `distance` (m, 0 or more) away: it rises with `stiffness` (N/m),
/// stays at `most` (N), and falls as steeply to zero at `range` (m). It is continuous.
[[nodiscard]] double pull(double distance, double stiffness, double range, double most) noexcept;

/// How far a tool is within the reach of a pull, 0 to 1: one in the inner three quarters of its
/// range (m).
[[nodiscard]] double hold(double distance, double range) noexcept;

/// The force on a tool at `tool` (m) that moves at `velocity` (m/s), N, in the frame of all of
/// these. `surface`: of the magnet's object, as seen from the tool.
[[nodiscard]] Vector3 hand_effect_force(const HandEffect& effect, const Vector3& tool,
                                        const Vector3& velocity,
                                        const NearSurface& surface) noexcept;

}  // namespace spm
