// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/vector.hpp"

namespace spm {

/// Point of the triangle a, b, c closest to `point`; all in one frame, metres. For a degenerate
/// triangle the result is a point within its longest edge or a corner. It is never NaN for finite
/// input.
[[nodiscard]] Vector3 closest_on_triangle(const Vector3& point, const Vector3& a, const Vector3& b,
                                          const Vector3& c) noexcept;

/// A part of a triangle: its face, a side or a corner.
enum class TriangleFeature : unsigned { face, ab, bc, ca, a, b, c };

[[nodiscard]] constexpr bool is_side(TriangleFeature feature) noexcept {
  return feature != TriangleFeature::face && feature < TriangleFeature::a;
}

struct ClosestFeature {
  Vector3 point = Vector3::Zero();
  Vector3 normal = Vector3::Zero();                 ///< of the triangle, of no certain length
  TriangleFeature feature = TriangleFeature::face;  ///< which the point lies on
};

/// closest_on_triangle, and the part that the point lies on.
[[nodiscard]] ClosestFeature closest_feature(const Vector3& point, const Vector3& a,
                                             const Vector3& b, const Vector3& c) noexcept;

}  // namespace spm
