// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "common/vector.hpp"

namespace spm {

/// A box that may be turned; metres, in an asset's frame.
struct OrientedBox {
  Vector3 middle = Vector3::Zero();
  Eigen::Matrix3d axes =
      Eigen::Matrix3d::Identity();  ///< unit columns, the directions of its edges
  Vector3 half = Vector3::Zero();   ///< half of each edge's length

  /// The point of the box that is closest to another.
  [[nodiscard]] Vector3 closest(const Vector3& point) const {
    const Vector3 at = axes.transpose() * (point - middle);
    return middle + axes * at.cwiseMax(-half).cwiseMin(half);
  }
};

}  // namespace spm
