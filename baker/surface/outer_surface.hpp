// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "baker/mesh/mesh.hpp"

namespace spm::baker {

/// Closed surfaces whose winding number tells the side of a place.
struct ClosedSurfaces {
  std::vector<Vector3> vertices;
  std::vector<Triangle> triangles;
  /// Of the triangles that are felt, whether some beside it may be told a wrong side by them.
  std::vector<char> doubtful;
  double gap = 0;  ///< m: what is nearer to these, and not to what is felt, is in a closed gap
};

/// The surface that a hand coming from outside can touch: the boundary of the union of all solids,
/// and what of the sheets lies outside that. Triangles are split where they intersect a solid, and
/// hidden pieces are removed. Each triangle of a solid has the solid behind it.
struct OuterSurface {
  std::vector<Vector3> vertices;
  std::vector<Triangle> triangles;
  std::size_t solid_count = 0;  ///< triangles before this index are of solids, the rest of sheets
  std::size_t hidden = 0;       ///< pieces removed because they lie inside other parts
  Counted intersecting;         ///< triangles of the mesh that were split; a vertex of the mesh
  double hidden_area = 0;       ///< m2
  /// The solids' boundary before narrow gaps were closed, where what is felt does not close any
  /// more; else nothing, and what is felt tells the side.
  std::shared_ptr<const ClosedSurfaces> sides;

  [[nodiscard]] bool has_sheets() const noexcept { return solid_count < triangles.size(); }
};

/// Splits triangles along their intersections with solids. Keeps of solids the pieces that have
/// their outside on one side, which close, and of sheets those that lie outside. Gaps between
/// triangles that face each other within `narrow`, m, are closed: what bounds them goes.
[[nodiscard]] OuterSurface outer_surface(const Mesh& mesh, double narrow = 0);

/// The same without the sheets.
[[nodiscard]] OuterSurface solids_of(const OuterSurface& surface);

}  // namespace spm::baker
