// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "baker/mesh/mesh.hpp"

namespace spm::baker {

/// Triangles that share vertices, and so edges; metres.
struct SurfaceMesh {
  std::vector<Vector3> vertices;
  std::vector<Triangle> triangles;
};

/// An edge of a mesh.
struct MeshEdge {
  std::array<std::uint32_t, 2> ends{};  ///< ascending
  double area = 0;                      ///< a third of the area of its triangles, m2
  int triangles = 0;
  double turn = 0;     ///< largest angle between the normals of two of its triangles, rad
  bool paired = true;  ///< as many triangles run along it in one direction as in the other
};

struct MeshEdges {
  std::vector<MeshEdge> edges;  ///< by their ends, ascending
  std::vector<std::array<std::uint32_t, 3>>
      of_sides;  ///< by triangle: the edge from corner k to k + 1
};

[[nodiscard]] MeshEdges edges_of(const SurfaceMesh& surface_mesh);

/// The same triangles with their vertices in another order, in which neighbours in space are near
/// each other in memory. Vertices without a triangle are dropped.
[[nodiscard]] SurfaceMesh in_order_of_space(const SurfaceMesh& surface_mesh);

}  // namespace spm::baker
