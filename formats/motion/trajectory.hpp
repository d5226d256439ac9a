// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/hand_pose.hpp"
#include "common/base/vector.hpp"

namespace spm {

/// One row of a recorded trajectory, in the asset's or the hand's frame, metres; orientation w x y
/// z, a unit quaternion.
struct TrajectorySample {
  Vector3 position = Vector3::Zero();
  double qw = 1, qx = 0, qy = 0, qz = 0;

  [[nodiscard]] HandPose pose() const noexcept {
    return {position, Eigen::Quaterniond(qw, qx, qy, qz)};
  }
};

/// Reads one `x y z` or `x y z qw qx qy qz` per line, separated by white space or commas. `#`
/// starts a comment, and blank lines are ignored. Independent of the locale. Used for trajectories
/// and for lists of points. Errors: file_or_device; invalid_input with the line (wrong count, not a
/// number, not finite).
[[nodiscard]] Result<std::vector<TrajectorySample>> read_trajectory(const std::string& path);

}  // namespace spm
