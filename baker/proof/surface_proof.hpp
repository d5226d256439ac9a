// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "baker/base/progress.hpp"
#include "baker/cast/cast.hpp"
#include "common/surface/tile.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// A piece of a surface triangle that no tile covers.
struct SurfacePiece {
  std::array<Vector3, 3> corners;
  std::uint32_t triangle = 0;  ///< of the caster, whose plane it lies in
};

/// The cells of a tile on which the proof of a triangle rests.
struct TileUse {
  std::uint32_t tile = 0;
  std::uint64_t cells = 0;
};

/// What covers each triangle of a surface.
struct SurfaceCover {
  std::vector<std::vector<TileUse>> uses;       ///< by triangle; each tile once
  std::vector<std::vector<SurfacePiece>> open;  ///< by triangle: what no tile covers
};

/// Proves that every point of the surface lies within `bound` metres of a tile, and lists the
/// pieces for which it cannot. Together with prove_tiles this bounds the Hausdorff distance of the
/// two. The distances from any point to the one and to the other then differ by at most `bound`.
///
/// A triangle is cut into pieces until each piece is proven. A piece is proven where the tile's
/// depths at all samples around it differ from the triangle's plane by at most the bound. It is
/// also proven where all its corners are within the bound of one cell, less what the twist of the
/// cell may add. Where several tiles would do, the first is named. Triangles of the fallback must
/// represent the pieces that cannot be proven.
///
/// `farthest`, m: the largest distance that a query answers. Over it the slack of the query's
/// closest point on a cell is taken off the bound. See PROOF.md.
[[nodiscard]] SurfaceCover prove_surface(const Caster& caster,
                                         const std::vector<SupportPlane>& planes,
                                         const std::vector<Tile>& tiles, double height_unit,
                                         double bound, double farthest, const Progress& progress);

}  // namespace spm::baker
