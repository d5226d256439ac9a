// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <numbers>
#include <vector>

#include "baker/base/progress.hpp"
#include "baker/options/bake_report.hpp"
#include "baker/reachability/reachability.hpp"
#include "baker/tiles/tiles.hpp"
#include "baker/trees/sign_octree_build.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// Where the median error of directions (rad) is above `max_direction`, finer tiles are tried, as
/// long as the asset takes no more than `direction_bytes` bytes.
inline constexpr double max_direction = 0.95 * std::numbers::pi / 180;
inline constexpr double direction_bytes = 0.98e6;

/// What a model is made from.
struct ModelSource {
  const Caster& caster;
  const SignOctreeBuilder& sign_octree;
  const Reachability& reachability;
  double tolerance;  ///< m, to be proven
  std::uint64_t seed;
  const Progress& progress;
};

/// The content of a `sparse` asset.
struct SparseModel {
  Asset asset;  ///< with tiles, triangles and both trees
  std::vector<Pruned> pruned;
  std::uint64_t refused_cells = 0;  ///< cells of tiles that could not be proven and were removed
  double triangle_area_share = 0;
  double direction = 0;  ///< median error, rad
  double bytes = 0;      ///< estimate
  double seconds_cast = 0;
};

/// Makes the model of a surface: tiles that are proven, the choice between tiles and triangles, and
/// the tree over them. `start` has metadata and planes only. The model is made again with finer
/// tiles where directions ask for it and a file of a sensible size allows it. Throws BakeError
/// where nothing of the object is left to model.
[[nodiscard]] SparseModel model_surface(const Asset& start, const TileSettings& settings,
                                        const ModelSource& source);

}  // namespace spm::baker
