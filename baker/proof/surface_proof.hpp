// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "baker/cast/cast.hpp"
#include "baker/base/progress.hpp"
#include "common/surface/tile.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// A piece of a surface triangle that no tile stands for.
struct SurfacePiece {
  std::array<Vector3, 3> corners;
  std::uint32_t triangle = 0;  ///< of the caster, whose plane it lies in
};

/// Proves that the tiles and the true surface lie within `bound` metres of each other, both ways;
/// then every distance to one differs from that to the other by at most as much, since the distance
/// to a set changes by no more than the set is moved (Hausdorff).
///
/// From tile to surface: a cell, clipped as it is, is cut into parts until each is proven. A part
/// lies in the convex hull of its corners, and the distance to one triangle is convex, so a part is
/// proven where all its corners are within the bound of one triangle; or where the middle's
/// distance and its size together are. Cells that resist are taken out of `valid`.
///
/// From surface to tile: a triangle is cut into pieces until each is proven. A piece is proven
/// where the tile's depths at all samples around it differ from the triangle's plane by at most the
/// bound; or where its corners all are within it of one cell, less what the cell's twist may add.
/// Where several tiles would do, the first is named. What resists the fallback has to stand for.
struct ProofCounts {
  std::uint64_t cells = 0;          ///< that were to be proven
  std::uint64_t refused_cells = 0;  ///< that resisted and were taken out
};

void prove_tiles(const Caster& caster, const std::vector<SupportPlane>& planes,
                 std::vector<TileData>& tiles, double tile_spacing, double height_unit,
                 double bound, const Progress& progress, ProofCounts& counts);

/// How many tries a proof is worth, as a share of the most: 1, but less where the bound is so small
/// against the diagonal that most would be in vain.
[[nodiscard]] inline double worthwhile_tries(double bound, double diagonal) {
  constexpr double small_bound_share = 1e-4;
  return std::min(1.0, std::pow(bound / (small_bound_share * diagonal), 2));
}

/// Cells of a tile that the proof of a triangle rests on.
struct TileUse {
  std::uint32_t tile = 0;
  std::uint64_t cells = 0;
};

/// What stands for each triangle of a surface.
struct SurfaceCover {
  std::vector<std::vector<TileUse>> uses;       ///< a triangle each, a tile once
  std::vector<std::vector<SurfacePiece>> open;  ///< a triangle each: what no tile stands for
};

[[nodiscard]] SurfaceCover prove_surface(const Caster& caster,
                                         const std::vector<SupportPlane>& planes,
                                         const std::vector<Tile>& tiles, double height_unit,
                                         double bound, double farthest, const Progress& progress);

/// Keeps of each tile that is not whole the cells in `used` alone, and drops tiles of which none is
/// used: what no proof rests on is only in the way.
void trim_tiles(std::vector<TileData>& tiles, const std::vector<std::uint64_t>& used);

}  // namespace spm::baker
