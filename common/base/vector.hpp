// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace spm {

/// A point, direction or force in three dimensions; doubles, SI units.
using Vector3 = Eigen::Vector3d;

}  // namespace spm
