// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "baker/mesh/mesh.hpp"

namespace spm::baker {

/// Triangles that share vertices, and so edges; metres.
struct Sheet {
  std::vector<Vector3> vertices;
  std::vector<Triangle> triangles;
};

/// An edge of a sheet.
struct SheetEdge {
  std::array<std::uint32_t, 2> ends{};  ///< ascending
  double area = 0;                      ///< a third of the area of its triangles, m2
  int triangles = 0;
  double turn = 0;     ///< largest angle between the normals of two of its triangles, rad
  bool paired = true;  ///< as many triangles run along it in one direction as in the other
};

struct SheetEdges {
  std::vector<SheetEdge> edges;  ///< by their ends, ascending
  std::vector<std::array<std::uint32_t, 3>>
      of_sides;  ///< by triangle: the edge from corner k to k + 1
};

[[nodiscard]] SheetEdges edges_of(const Sheet& sheet);

/// The same triangles with their vertices in another order, in which neighbours in space are near
/// each other in memory. Vertices without a triangle are dropped.
[[nodiscard]] Sheet in_order_of_space(const Sheet& sheet);

}  // namespace spm::baker
