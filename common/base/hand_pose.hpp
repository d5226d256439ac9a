// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "common/base/vector.hpp"

namespace spm {

/// Where a device's tool is: its origin in m, and its orientation; the device's frame, or the
/// world's.
struct HandPose {
  Vector3 position = Vector3::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  ///< unit
};

}  // namespace spm
