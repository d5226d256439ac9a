// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

namespace spm {

/// How far rounding may take a pose's axes from unit length and from right angles.
inline constexpr double pose_rounding = 1e-6;

/// Whether a pose keeps lengths: it is finite, and it may rotate, mirror and translate, but neither
/// scales nor shears. A pose made of a quaternion that is not of unit length does not keep them.
[[nodiscard]] inline bool keeps_lengths(const Eigen::Isometry3d& pose) noexcept {
  const Eigen::Matrix3d square = pose.linear().transpose() * pose.linear();
  return pose.translation().allFinite() &&
         (square - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= pose_rounding;
}

}  // namespace spm
