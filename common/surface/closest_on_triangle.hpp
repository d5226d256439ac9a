// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/vector.hpp"

namespace spm {

/// Point of the triangle a, b, c closest to `point`; all in one frame, metres. For a degenerate
/// triangle the result is a point within its longest edge or a corner. It is never NaN for finite
/// input.
[[nodiscard]] Vector3 closest_on_triangle(const Vector3& point, const Vector3& a, const Vector3& b,
                                          const Vector3& c) noexcept;

}  // namespace spm
