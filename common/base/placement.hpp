// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "common/base/vector.hpp"

namespace spm {

/// Pose and scale of a frame in the world: p_world = position + scale * rotation * p; position in
/// metres.
struct Placement {
  Vector3 position = Vector3::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  double scale = 1;  ///< above 0

  /// Transforms a point from the frame to the world, m.
  [[nodiscard]] Vector3 to_world(const Vector3& point) const noexcept {
    return position + scale * (rotation * point);
  }
  /// Transforms a point from the world to the frame, m.
  [[nodiscard]] Vector3 from_world(const Vector3& point) const noexcept {
    return rotation.conjugate() * (point - position) / scale;
  }
};

}  // namespace spm
