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
  double residual = 0;     ///< m: how far a cell may be off the surface, along its normal
  double angle = 0;        ///< rad: by how much a tile's normals may be off in the mean
  double cell_angle = 0;   ///< rad: the same for one cell
  bool faceted = false;    ///< see TileSettings
};

/// The place on the surface from which a tile is grown, in the plane's frame, m.
struct TileSeed {
  double eta = 0, omega = 0, depth = 0;
};

/// A fitted tile. It is not good where its normals are off too far or where no cell is left.
struct TileFit {
  TileData data;
  bool good = false;
};

/// Fits one tile to the layer of surface around a seed. It follows that layer over the tile by
/// rays, and fits bilinear heights to it by least squares, smooth where the layer ends. It keeps
/// the cells that agree with the surface. A cell that a crease crosses is kept up to a line along
/// the crease. Empty where the seed is on no surface. All heights are as the file stores them.
[[nodiscard]] std::optional<TileFit> fit_tile(const Caster& caster, const TileSite& site,
                                              const TileSeed& seed);

/// The tile as queries see it. It points into `data`, which must outlive it.
[[nodiscard]] Tile view_of(const TileData& data, double tile_spacing, double height_unit);

}  // namespace spm::baker
