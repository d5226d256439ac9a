// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/base/progress.hpp"
#include "baker/cast/cast.hpp"
#include "baker/cast/surface_points.hpp"
#include "baker/options/bake_options.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// A sample point of the surface in the frame of a plane.
struct Surfel {
  Vector3 point = Vector3::Zero();
  std::uint32_t triangle = 0;
  std::uint32_t direction = 0;  ///< the plane that faces it best
  double eta = 0, omega = 0, depth = 0;
};

/// How tiles are judged; see TileSite.
struct TileSettings {
  double tile_spacing = 0;  ///< m, of level 0
  double height_unit = 1;   ///< m
  std::uint32_t levels = 5;
  double residual = 0;      ///< m
  double angle = 0.02;      ///< rad, of level 0; each level may double it
  double cell_angle = 0.3;  ///< rad
  /// Fit most of the slopes well rather than all equally: for surfaces whose facets are smaller
  /// than tiles.
  bool faceted = false;
  double surfel_spacing = 0;  ///< m
  /// A tile must newly cover this share of the surfels that a full tile would cover, or it is not
  /// worth its bytes. `last_worthwhile` is the same for the last level.
  double worthwhile = 0.3;
  double last_worthwhile = 0.1;
  /// Tiles are not cast where fewer triangles lie, by the density of the surfels.
  double least_triangles = 0;
};

/// Casts the tiles of a `sparse` asset that cover points of the surface. Each point is covered by
/// tiles of the direction that faces it best. Coarse tiles come first, then finer ones where the
/// coarse ones do not agree with the surface. Of all possible tiles the one that covers most is
/// always taken.
[[nodiscard]] std::vector<TileData> cast_tiles(const Caster& caster,
                                               const std::vector<SupportPlane>& planes,
                                               const TileSettings& settings,
                                               const std::vector<SurfacePoint>& points,
                                               const Progress& progress);

}  // namespace spm::baker
