// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/field/distance_octree.hpp"

namespace spm {

/// Of a bound from below, so that rounding cannot make it too long.
inline constexpr double shortened_bound = 1 - 1e-9;

/// Lower bound of the distance from a point to the nearest cube of the octree that is not `far`, m;
/// at most `most`. All that is nearer is outside and beyond the margin. Octree's frame. Never
/// throws or allocates.
[[nodiscard]] double distance_to_band(const DistanceOctree& octree, const Vector3& point,
                                      double most) noexcept;

}  // namespace spm
