// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/base/progress.hpp"
#include "baker/cast/cast.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// What the proof of the tiles came to.
struct ProofCounts {
  std::uint64_t cells = 0;          ///< that had to be proven
  std::uint64_t refused_cells = 0;  ///< that could not be proven and were removed
};

/// Proves that every point of the tiles lies within `bound` metres of the surface. Cells that
/// cannot be proven are removed from `valid`.
///
/// A cell is cut into parts until each part is proven; a clipped cell counts up to its clip line. A
/// part lies in the convex hull of its corners, and the distance to one triangle is a convex
/// function. So a part is proven where all its corners are within the bound of one triangle. It is
/// also proven where the distance of its middle plus its size is within the bound.
void prove_tiles(const Caster& caster, const std::vector<SupportPlane>& planes,
                 std::vector<TileData>& tiles, double tile_spacing, double height_unit,
                 double bound, const Progress& progress, ProofCounts& counts);

/// Keeps only the cells in `used` of each tile that has a mask, and drops tiles of which no cell is
/// used. A cell that no proof rests on is only in the way. A tile with all its cells is kept as it
/// is, since it needs no mask.
void trim_tiles(std::vector<TileData>& tiles, const std::vector<std::uint64_t>& used);

}  // namespace spm::baker
