// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

#include "common/field/indexed_triangles.hpp"
#include "common/field/triangle_list.hpp"

namespace spm {

enum class ListPart { surface, caps };

struct NearestTriangle {
  std::uint32_t triangle = 0;
  /// Of its distance, m^2, in single precision; infinite where there is none.
  float square = std::numeric_limits<float>::infinity();
};

/// The nearest triangle of one part of a list, by several at once in single precision. Packets that
/// are too far to matter are passed over: `reach` is what 255 of a list's bounds stand for, m.
[[nodiscard]] NearestTriangle nearest_triangle(const IndexedTriangles& mesh,
                                               const TriangleList& list, ListPart part,
                                               double reach, const Vector3& point) noexcept;

}  // namespace spm
