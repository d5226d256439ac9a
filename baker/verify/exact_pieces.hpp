// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "baker/mesh/mesh.hpp"
#include "baker/verify/exact_winding.hpp"
#include "common/base/vector.hpp"

namespace spm::baker {

/// The part of a mesh's surface that bounds the union of its solids, and what of its sheets is
/// outside that, as loose triangles. Those of solids run anticlockwise, seen from outside.
struct SurfacePieces {
  std::vector<std::array<Vector3, 3>> solids, sheets;
  double hidden_area = 0;    ///< m2, of the mesh, inside other parts
  bool gaps_closed = false;  ///< some triangles face others across a narrow gap, or across none
};

/// Cuts each triangle along its intersections with those of solids, and keeps of solids the pieces
/// with the inside on one side only, of sheets those with the outside on both. A point is inside
/// where its winding number is above one half. Gaps between triangles that face each other within
/// `narrow`, m, are closed: what bounds them goes.
[[nodiscard]] SurfacePieces outer_pieces(const Mesh& mesh, const ExactWinding& winding,
                                         double narrow);

}  // namespace spm::baker
