// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "baker/base/progress.hpp"
#include "baker/cast/cast.hpp"
#include "baker/charts/chart_heights.hpp"
#include "baker/field/lattice_surface.hpp"
#include "baker/reachability/reachability.hpp"
#include "common/asset/asset_view.hpp"
#include "common/field/distance_octree.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// What the octree is built for.
struct OctreeRules {
  Band band;
  double tolerance = 0;         ///< m: of every answer
  double smallest_edge = 0;     ///< m: cubes are divided down to this
  int levels = 3;               ///< from the roots to the smallest cubes
  double direction = 0;         ///< rad: directions in a cube are off by at most this in the mean
  std::optional<double> bytes;  ///< that octree, maps and triangles may take at most
  bool maps = true;             ///< whether maps may answer, or lists alone
};

struct OctreeCounts {
  std::uint64_t maps = 0, map_pairs = 0, lists = 0, listed_triangles = 0;
  double answered_volume = 0;             ///< m^3
  std::array<double, 4> pruned_volume{};  ///< m^3, by PruneRule
  std::uint64_t bytes = 0;                ///< of all words and maps

  [[nodiscard]] std::uint64_t leaves() const noexcept { return maps + map_pairs + lists; }
};

struct BuiltOctree {
  OctreeData data;
  AtlasData atlas;
  std::vector<SupportPlane> planes;  ///< of the atlas
  OctreeCounts counts;
  std::size_t untold = 0;  ///< lists beside doubted triangles that tell no side
};

/// Builds the distance octree of a surface, which `caster` is over too, and proves each of its
/// maps. `heights` are of the same surface. `reachability` may be null. The same for any number of
/// threads. Throws BakeError where nothing of the object is left to model.
[[nodiscard]] BuiltOctree build_octree(const LatticeSurface& surface, const Caster& caster,
                                       const ChartHeights& heights,
                                       const Reachability* reachability, const OctreeRules& rules,
                                       const Progress& progress);

}  // namespace spm::baker
