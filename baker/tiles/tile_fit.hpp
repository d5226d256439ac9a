// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "baker/cast/cast.hpp"
#include "common/surface/tile.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// Where a tile lies and how it is judged.
struct TileSite {
  const SupportPlane& plane;
  std::uint32_t which = 0;  ///< of the plane
  std::uint32_t level = 0;
  std::int32_t column = 0, row = 0;
  double spacing = 0;      ///< m, exactly as the file gives it
  double height_unit = 1;  ///< m
  double residual = 0;     ///< m: how far, across the surface, a cell may leave it
  double angle = 0;        ///< rad: how far off a tile's normals may be in the mean
  double cell_angle = 0;   ///< rad: and a cell's
  bool faceted = false;    ///< see TileSettings
};

/// A place of the surface that a tile is grown from, in the plane's frame, m.
struct TileSeed {
  double eta = 0, omega = 0, depth = 0;
};

/// A fitted tile; not good where its normals are off too far or no cell is left.
struct TileFit {
  TileData data;
  bool good = false;
};

/// Fits one tile to the sheet of surface around a seed: follows the sheet over the tile by rays,
/// fits the bilinear heights to it by least squares, smooth where the sheet ends; keeps the cells
/// that agree with the surface, and those that a crease crosses up to a line along it. Nothing
/// where the seed is on no sheet. All heights are as the file stores them.
[[nodiscard]] std::optional<TileFit> fit_tile(const Caster& caster, const TileSite& site,
                                              const TileSeed& seed);

/// The tile as queries see it; points into `data`, which must outlive it.
[[nodiscard]] Tile view_of(const TileData& data, double tile_spacing, double height_unit);

}  // namespace spm::baker
