// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "baker/charts/atlas.hpp"
#include "baker/field/cube_candidates.hpp"
#include "baker/reachability/reachability.hpp"
#include "common/field/distance_octree.hpp"
#include "common/field/triangle_list.hpp"

namespace spm::baker {

/// A triangle of a list.
struct ListedCandidate {
  std::uint32_t triangle = 0;
  double bound = 0;  ///< m: it is at least this far from every point of the cube
};

/// A cube of the distance octree while it is built.
struct OctreeNode {
  OctreeKind kind = OctreeKind::far;
  Cube cube;
  std::uint32_t direction = 0;          ///< outwards, of a deep cube: its word
  std::vector<ChartAtLevel> charts;     ///< of maps: one, or two
  MapPair pair;                         ///< of two maps
  double shared_bytes = 0;              ///< of maps: what their heights take, beside other cubes
  double clearance = 0;                 ///< of a far one's middle, m
  std::vector<ListedCandidate> solids;  ///< triangles of a list
  std::vector<ListedCandidate> sheets;  ///< likewise
  ListSide side = ListSide::surface;    ///< of a list
  std::optional<KnownPlace> known;      ///< of a list that the surface passes
  std::vector<std::uint32_t> crossed;   ///< of such a list: numbers of LatticeSurface::any_triangle
  PruneRule rule = PruneRule::none;     ///< of a pruned cube
  std::unique_ptr<std::array<OctreeNode, 8>> octants;
  /// All that may be the nearest to some place of the cube, by number; nothing
  /// where these are more than `few_triangles`, or not known.
  std::optional<std::vector<std::uint32_t>> few;
  std::optional<bool> inside;  ///< where no solid cuts the cube
  bool as_list = false;        ///< a split cube that is better a list (make_lists)
};

/// Gives a split cube what its octants have in common, their few triangles and their side, and
/// makes it one cube where all of them are far or pruned.
void join_octants(OctreeNode& node);

/// The side that a list tells.
[[nodiscard]] inline ListSide side_of(std::optional<bool> inside) noexcept {
  return !inside ? ListSide::surface : *inside ? ListSide::inside : ListSide::outside;
}

/// Cubes with more triangles are not made lists to save bytes.
inline constexpr std::size_t few_triangles = unbounded_packets * packet_size;

}  // namespace spm::baker
