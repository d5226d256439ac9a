// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "common/field/indexed_triangles.hpp"
#include "common/field/triangle_list.hpp"
#include "common/surface/closest_on_triangle.hpp"

namespace spm {

enum class ListPart { solids, sheets };

/// The nearest triangle of a list, in single precision.
struct NearestTriangle {
  std::uint32_t triangle = 0;
  /// Of its distance, in lattice steps squared; infinite where there is none.
  float square = std::numeric_limits<float>::infinity();
  /// Whether what follows is there: not of thin triangles.
  bool has_closest = false;
  std::array<float, 3> away{};  ///< from the closest point to the place, lattice steps
  /// Of that, along the triangle's normal, of no certain length; 0 as side_told wants it.
  float along = 0;
  TriangleFeature feature = TriangleFeature::face;  ///< on which the closest point lies
};

/// The nearest triangle of one part of a list, by several at once in single precision. Packets that
/// are too far to matter are passed over: `reach` is what 255 of a list's bounds stand for, m.
[[nodiscard]] NearestTriangle nearest_triangle(const IndexedTriangles& mesh,
                                               const TriangleList& list, ListPart part,
                                               double reach, const Vector3& point) noexcept;

}  // namespace spm
