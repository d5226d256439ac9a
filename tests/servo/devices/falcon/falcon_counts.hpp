// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "servo/devices/falcon/falcon_kinematics.hpp"

namespace spm::test {

/// Encoder counts of thigh angles (rad), not rounded: the inverse of falcon_angles.
[[nodiscard]] inline Vector3 falcon_counts(const Vector3& angles) {
  constexpr std::int16_t many = 10000;
  const Vector3 none = servo::falcon_angles({0, 0, 0});
  return (angles - none).cwiseQuotient(servo::falcon_angles({many, many, many}) - none) * many;
}

}  // namespace spm::test
