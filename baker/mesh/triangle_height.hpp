// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "common/base/vector.hpp"

namespace spm::baker {

/// The longest side of a triangle, m.
[[nodiscard]] inline double longest_side(const Vector3& a, const Vector3& b, const Vector3& c) {
  return std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
}

/// Which side of a triangle, from corner k to the next, is the longest, the first of several.
[[nodiscard]] inline std::size_t which_longest_side(const std::array<Vector3, 3>& t) {
  const std::array<double, 3> lengths{(t[1] - t[0]).norm(), (t[2] - t[1]).norm(),
                                      (t[0] - t[2]).norm()};
  return static_cast<std::size_t>(std::max_element(lengths.begin(), lengths.end()) -
                                  lengths.begin());
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
