// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "common/base/vector.hpp"

namespace spm {

/// The turn that takes one orientation to another, as axis times angle (rad, at most pi), world
/// frame. Both unit.
[[nodiscard]] inline Vector3 turn_between(const Eigen::Quaterniond& from,
                                          const Eigen::Quaterniond& to) noexcept {
  const Eigen::Quaterniond turn = to * from.conjugate();
  const double size = turn.vec().norm();
  if (size == 0) return Vector3::Zero();
  const double angle = 2 * std::atan2(size, std::abs(turn.w()));
  return turn.vec() * (turn.w() < 0 ? -angle / size : angle / size);
}

}  // namespace spm
