// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <numbers>

#include "baker/mesh/mesh.hpp"
#include "common/base/vector.hpp"

namespace spm::test {

/// Signed solid angle of a triangle seen from a point, divided by 4 pi: the triangle's part of the
/// winding number. Positive where the point is behind the triangle (Van Oosterom and Strackee
/// 1983).
[[nodiscard]] inline double triangle_winding(const Vector3& point, const Vector3& a,
                                             const Vector3& b, const Vector3& c) {
  const Vector3 to_a = a - point, to_b = b - point, to_c = c - point;
  const double length_a = to_a.norm(), length_b = to_b.norm(), length_c = to_c.norm();
  const double x = length_a * length_b * length_c + to_a.dot(to_b) * length_c +
                   to_b.dot(to_c) * length_a + to_c.dot(to_a) * length_b;
  return std::atan2(to_a.dot(to_b.cross(to_c)), x) / (2 * std::numbers::pi);
}

/// The winding number of a mesh, by the sum over its triangles.
[[nodiscard]] inline double summed_winding(const baker::Mesh& mesh, const Vector3& point) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    sum += triangle_winding(point, mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
  }
  return sum;
}

}  // namespace spm::test
