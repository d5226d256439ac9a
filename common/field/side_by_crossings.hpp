// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/field/indexed_triangles.hpp"
#include "common/field/triangle_list.hpp"

namespace spm {

/// Gaps between parts, and rounding between walls of them that touch, are no wider than this, in
/// steps of the lattice.
inline constexpr double gap_steps = 6;

/// Whether a point of a list's cube is inside the solids: the side of a place that the list knows,
/// and the triangles that the way from there to the point crosses (those that the list has for
/// that, or its solids). Exact but where the point lies on the surface to within rounding. Nothing
/// where the list knows no place. A point that is `away` from the surface, m, and in a gap between
/// parts is inside.
[[nodiscard]] std::optional<bool> side_by_crossings(const IndexedTriangles& mesh,
                                                    const TriangleList& list, const Vector3& middle,
                                                    double half, const Vector3& point,
                                                    double away) noexcept;

}  // namespace spm
