// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "baker/bake.hpp"
#include "baker/cast.hpp"
#include "baker/surface_proof.hpp"
#include "formats/asset.hpp"

namespace spm::baker {

/// What the spatial partition of a `sparse` asset came to.
struct TilePartitionCounts {
  std::uint64_t leaves = 0;        ///< cells with a list
  std::uint64_t with_triangles = 0;
  std::uint64_t exact = 0;         ///< of them, that list the surface's own triangles and no tile
  std::array<std::uint64_t, 8> pruned_leaves{};  ///< by rule
  std::array<std::uint64_t, 8> pruned_bytes{};   ///< by rule
};

/// Why a cube need not be modelled, as a rule's number; 0 where it must be. May be empty.
using PruneTest = std::function<unsigned(const Vector3& middle, double edge)>;

/// Fills the grid and the fallback of a `sparse` asset whose tiles are proven, and drops tiles that
/// no cell lists. For every cell of the band it lists each tile and piece that can be the nearest
/// anywhere in the cell: in a cube of half diagonal r around q an element cannot if its distance
/// from q is more than the least plus 2 r, since both change by at most the way; cubes are halved
/// until the lists are short. The side is tried at points of every smallest cube; where it comes out
/// wrong the surface's own triangles are listed instead.
[[nodiscard]] TilePartitionCounts partition_tiles(Asset& asset, const Caster& caster,
                                                  const std::vector<SurfacePiece>& pieces,
                                                  double tolerance, const PruneTest& prune,
                                                  const Progress& progress);

}  // namespace spm::baker
