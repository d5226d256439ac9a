// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <numbers>
#include <vector>

#include "baker/base/progress.hpp"
#include "baker/options/bake_report.hpp"
#include "baker/reach/reach.hpp"
#include "baker/tiles/tiles.hpp"
#include "baker/trees/space_build.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// Directions that are off by more in the median, rad, ask for finer tiles, as long as all takes no
/// more bytes than so many.
inline constexpr double most_direction = 0.95 * std::numbers::pi / 180;
inline constexpr double direction_bytes = 0.98e6;

/// What a model is made from.
struct ModelSource {
  const Caster& caster;
  const SpaceBuilder& space;
  const Reach& reach;
  double tolerance;  ///< m, that is to be proven
  std::uint64_t seed;
  const Progress& progress;
};

/// What a `sparse` asset is made of.
struct SparseModel {
  Asset asset;  ///< with tiles, triangles and both trees
  std::vector<Pruned> pruned;
  std::uint64_t refused_cells = 0;  ///< of tiles, that their proof took out
  double triangle_area_share = 0;
  double direction = 0;  ///< median error, rad
  double bytes = 0;      ///< about
  double seconds_cast = 0;
};

/// Makes the model of a surface in the frame of `start`, which has metadata and planes only: tiles
/// that are proven, the choice between them and triangles, and the tree; made anew with finer tiles
/// where directions ask for them and a file of a sensible size gives them. Throws BakeError where
/// nothing of the object is left to model.
[[nodiscard]] SparseModel model_surface(const Asset& start, const TileSettings& settings,
                                        const ModelSource& source);

}  // namespace spm::baker
