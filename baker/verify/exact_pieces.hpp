// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "baker/mesh/mesh.hpp"
#include "baker/verify/exact_winding.hpp"
#include "common/base/vector.hpp"

namespace spm::baker {

/// The part of a mesh's surface that bounds the union of its parts, as loose triangles. Seen from
/// outside, their corners run anticlockwise.
struct SurfacePieces {
  std::vector<std::array<Vector3, 3>> triangles;
  double area = 0;         ///< m2
  double hidden_area = 0;  ///< m2, of the mesh, inside other parts
};

/// Cuts each triangle along its intersections with the others, and keeps the pieces with the inside
/// on one side only. A point is inside where its winding number is above one half. The winding
/// number has no steps near holes. There pieces are halved until the boundary is known to 1/5000 of
/// the diagonal.
[[nodiscard]] SurfacePieces outer_pieces(const Mesh& mesh, const ExactWinding& winding);

}  // namespace spm::baker
