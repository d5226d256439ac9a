// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "common/base/vector.hpp"

namespace spm {

/// Where a frame lies in the world, p_world = position + scale * rotation * p; position in metres.
struct Placement {
  Vector3 position = Vector3::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  double scale = 1;  ///< above 0

  /// A point of the frame as one of the world, m.
  [[nodiscard]] Vector3 to_world(const Vector3& point) const noexcept {
    return position + scale * (rotation * point);
  }
  /// A point of the world as one of the frame, m.
  [[nodiscard]] Vector3 from_world(const Vector3& point) const noexcept {
    return rotation.conjugate() * (point - position) / scale;
  }
};

}  // namespace spm
