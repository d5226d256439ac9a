// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "baker/mesh/mesh_edges.hpp"

namespace spm::baker {

/// Not thread-safe in CGAL 5.5: what constructs by it stays on one thread.
using ExactKernel = CGAL::Exact_predicates_exact_constructions_kernel;

[[nodiscard]] inline ExactKernel::Point_3 exact_point(const Vector3& p) {
  return {p.x(), p.y(), p.z()};
}

/// The two sides of a triangle by number: the one that its normal points to, and the other.
[[nodiscard]] constexpr std::uint32_t front(std::uint32_t triangle) noexcept {
  return 2 * triangle;
}
[[nodiscard]] constexpr std::uint32_t back(std::uint32_t triangle) noexcept {
  return 2 * triangle + 1;
}

/// Of a triangle at an edge the side that faces the next one around it, and the one before.
[[nodiscard]] constexpr std::uint32_t ahead(const HalfEdge& user) noexcept {
  return user.forward ? front(user.triangle) : back(user.triangle);
}
[[nodiscard]] constexpr std::uint32_t behind(const HalfEdge& user) noexcept {
  return user.forward ? back(user.triangle) : front(user.triangle);
}

/// A triangle at an edge.
struct FanLeaf {
  HalfEdge user;
  bool on_last = false;  ///< it lies on the one before it
};

/// The triangles at an edge in the order in which they stand around it, counter-clockwise as seen
/// against the edge's direction from low to high; by exact predicates. `place` gives a vertex.
[[nodiscard]] std::vector<FanLeaf> triangle_fan(
    const std::vector<Triangle>& triangles, std::span<const HalfEdge> users,
    const std::function<ExactKernel::Point_3(std::uint32_t)>& place);

}  // namespace spm::baker
