// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/vector.hpp"

namespace spm {

/// One row of a recorded trajectory, in the asset's or the hand's frame, metres; orientation w x y
/// z, unit.
struct TrajectorySample {
  Vector3 position = Vector3::Zero();
  double qw = 1, qx = 0, qy = 0, qz = 0;
};

/// Reads `x y z` or `x y z qw qx qy qz` a line, white space or commas between, `#` starts a
/// comment, blank lines ignored; independent of the locale. Used for trajectories and for lists of
/// points. Errors: file_or_device; invalid_input with the line (wrong count, not a number, not
/// finite).
[[nodiscard]] Result<std::vector<TrajectorySample>> read_trajectory(const std::string& path);

}  // namespace spm
