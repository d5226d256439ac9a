// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/vector.hpp"

namespace spm {

/// Point of the triangle a, b, c closest to `point`; all in one frame, metres. A degenerate
/// triangle gives a point of its longest edge's span or a corner, never NaN for finite input.
[[nodiscard]] Vector3 closest_on_triangle(const Vector3& point, const Vector3& a, const Vector3& b,
                                          const Vector3& c) noexcept;

}  // namespace spm
