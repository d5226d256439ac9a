// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/base/progress.hpp"
#include "baker/cast/cast.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// What an asset shows of its surface.
struct SurfaceTiles {
  std::vector<TileData> tiles;
  std::vector<bool> bare;           ///< by triangle of the caster: no tile shows all of it
  double bare_share = 0;            ///< their share of the area
  std::uint64_t refused_cells = 0;  ///< cells of tiles that could not be proven and were removed
};

/// Casts tiles all over the surface, proves that tiles and surface lie within the tolerance (m) of
/// each other, and keeps the tiles that take fewer bytes than the triangles they show. `asset` has
/// planes and band; its units of tiles are set.
[[nodiscard]] SurfaceTiles show_surface(const Caster& caster, Asset& asset, double tolerance,
                                        std::uint64_t seed, const Progress& progress);

}  // namespace spm::baker
