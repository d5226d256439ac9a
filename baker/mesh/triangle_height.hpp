// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "common/base/vector.hpp"

namespace spm::baker {

/// The longest side of a triangle, m.
[[nodiscard]] inline double longest_side(const Vector3& a, const Vector3& b, const Vector3& c) {
  return std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
}

/// The area of a triangle, m2.
[[nodiscard]] inline double triangle_area(const Vector3& a, const Vector3& b, const Vector3& c) {
  return (b - a).cross(c - a).norm() / 2;
}

/// How high a triangle is over its longest side, m; 0 where all corners are one.
[[nodiscard]] inline double triangle_height(const Vector3& a, const Vector3& b, const Vector3& c) {
  const double longest = longest_side(a, b, c);
  return longest > 0 ? (b - a).cross(c - a).norm() / longest : 0;
}

}  // namespace spm::baker
