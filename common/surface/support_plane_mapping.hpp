// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "common/surface/support_plane.hpp"

namespace spm {

/// Support plane mapping M_O(v) over a finite set E_O (Definition 2): index of the plane whose
/// normal is most parallel to `direction`; the lowest index in a tie. `planes` must not be empty;
/// `direction` need not be a unit vector.
[[nodiscard]] std::size_t support_plane_mapping(std::span<const SupportPlane> planes,
                                                const Vector3& direction) noexcept;

/// Support mapping s_O(v): index of the point of `points` that is farthest along `direction`; the
/// lowest index in a tie. `points` must not be empty.
[[nodiscard]] std::size_t support_mapping(std::span<const Vector3> points,
                                          const Vector3& direction) noexcept;

/// Vertex-based mapping (Fig. 1a): the support plane through s_O(normal) with the given unit
/// normal. The basis u, v is a fixed function of the normal.
[[nodiscard]] SupportPlane vertex_support_plane(std::span<const Vector3> points,
                                                const Vector3& normal) noexcept;

/// Completes a unit normal to a right-handed basis by a fixed, branch-stable rule.
[[nodiscard]] SupportPlane plane_with_normal(const Vector3& x0, const Vector3& normal) noexcept;

/// True where the point lies in the bounded space G, the intersection of all negative half-spaces,
/// each moved outwards by `slack` metres.
[[nodiscard]] bool in_bounded_space(std::span<const SupportPlane> planes, const Vector3& point,
                                    double slack) noexcept;

}  // namespace spm
