// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "common/query/query_cursor.hpp"
#include "common/sixdof/contact_sum.hpp"
#include "common/sixdof/surface_samples.hpp"

namespace spm {

/// Springs that are spread about a place, all of them below the surface of one field; one frame, m.
struct SpreadSpring {
  double spring = 0;              ///< N/m, of all together
  LocalQuadric field;             ///< about the place
  PatchMoments moments;           ///< of the springs about the place
  Vector3 arm = Vector3::Zero();  ///< the place, from the point that torques are about
};

struct PressedSpread {
  double pressing = 0;               ///< N
  double deepest = 0;                ///< m, as of springs that are spread evenly
  Vector3 force = Vector3::Zero();   ///< N
  Vector3 torque = Vector3::Zero();  ///< N m
  Vector3 moment = Vector3::Zero();  ///< N m: the sum of force times arm
};

/// Adds them to a sum, `count` contacts: the sum over the springs of ContactSum::add, with each
/// one's depth and direction from the field, to the second order in the distance from the place.
[[nodiscard]] PressedSpread press_spread(const SpreadSpring& spread, std::uint64_t count,
                                         ContactSum& sum) noexcept;

}  // namespace spm
