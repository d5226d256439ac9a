// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>

#include "common/base/vector.hpp"

namespace spm {

/// The numbers of a RecordingRow as what they are; quaternions w first.
[[nodiscard]] inline Vector3 vector_of(const std::array<double, 3>& numbers) noexcept {
  return {numbers[0], numbers[1], numbers[2]};
}
[[nodiscard]] inline Eigen::Quaterniond turn_of(const std::array<double, 4>& numbers) noexcept {
  return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

}  // namespace spm
