// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

namespace spm {

/// How far a pose's axes may be from unit and upright by rounding.
inline constexpr double pose_rounding = 1e-6;

/// Whether a pose keeps lengths: it turns, mirrors and moves, but neither scales nor shears, and is
/// finite. One made of a quaternion that is not unit does not.
[[nodiscard]] inline bool keeps_lengths(const Eigen::Isometry3d& pose) noexcept {
  const Eigen::Matrix3d square = pose.linear().transpose() * pose.linear();
  return pose.translation().allFinite() &&
         (square - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= pose_rounding;
}

}  // namespace spm
