// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/vector.hpp"

namespace spm {

/// Force and torque on an object, N and N m. Whoever returns one says about which point.
struct Wrench {
  Vector3 force = Vector3::Zero();
  Vector3 torque = Vector3::Zero();
};

}  // namespace spm
