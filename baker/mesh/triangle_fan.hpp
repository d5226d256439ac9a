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
