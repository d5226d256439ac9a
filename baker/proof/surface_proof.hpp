// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "baker/base/progress.hpp"
#include "baker/cast/cast.hpp"
#include "common/surface/tile.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// The cells of a tile on which the proof of a triangle rests.
struct TileUse {
  std::uint32_t tile = 0;
  std::uint64_t cells = 0;
};

/// What covers each triangle of a surface.
struct SurfaceCover {
  std::vector<std::vector<TileUse>> uses;    ///< by triangle; each tile once
  std::vector<std::optional<Vector3>> open;  ///< by triangle: a place that no tile covers
};

/// Proves of each triangle whether every point of it lies within `bound` metres of a tile.
///
/// A triangle is cut into pieces until each piece is proven. A piece is proven where the tile's
/// depths at all samples around it differ from the triangle's plane by at most the bound. It is
/// also proven where all its corners are within the bound of one cell, less what the twist of the
/// cell may add. Where several tiles would do, the first is named.
[[nodiscard]] SurfaceCover prove_surface(const Caster& caster,
                                         const std::vector<SupportPlane>& planes,
                                         const std::vector<Tile>& tiles, double height_unit,
                                         double bound, const Progress& progress);

}  // namespace spm::baker
