// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "baker/mesh/mesh.hpp"

namespace spm::baker {

/// A hole that caps close.
struct CappedHole {
  Vector3 middle;         ///< of its border, m
  double area = 0;        ///< of its caps, m2
  std::size_t edges = 0;  ///< of its border
};

/// The surface that a hand coming from outside can touch: the boundary of the union of all parts.
/// Triangles are split where parts intersect, and hidden pieces are removed. Each triangle has the
/// solid behind it.
struct OuterSurface {
  std::vector<Vector3> vertices;
  std::vector<Triangle> triangles;
  std::size_t surface_count = 0;  ///< triangles before this index are surface, the rest caps
  std::size_t hidden = 0;         ///< pieces removed because they lie inside other parts
  std::size_t intersecting = 0;   ///< triangles of the mesh that were split
  double hidden_area = 0;         ///< m2
  std::vector<CappedHole> caps;   ///< largest first
};

/// Splits self-intersecting triangles along their intersections. Keeps the pieces across which the
/// generalised winding number passes one half. Caps holes; caps decide the side only, and are cut
/// where they cross each other or the surface.
[[nodiscard]] OuterSurface outer_surface(const Mesh& mesh);

/// Cuts caps, and what they cross, along each other, so that each piece has one winding number on
/// each side.
void split_caps(OuterSurface& surface);

}  // namespace spm::baker
