// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "baker/mesh/winding_number.hpp"
#include "baker/surface/triangle_split.hpp"

namespace spm::baker {

/// The winding numbers on both sides of a piece, all that lie on it included.
struct PieceWinding {
  int front = 0;  ///< where its normal points to
  int back = 0;
};

/// Of the first `count` pieces, which are closed: from each piece to those at its edges, by exact
/// predicates (Zhou et al. 2016), so that what is kept by them closes. Of each part that hangs
/// together `winding` is asked at a few pieces. `diagonal`: of the mesh, m.
[[nodiscard]] std::vector<PieceWinding> winding_of_pieces(const SplitMesh& split, std::size_t count,
                                                          const WindingNumber& winding,
                                                          double diagonal);

}  // namespace spm::baker
