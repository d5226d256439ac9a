// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/proof/surface_proof.hpp"

namespace spm::baker {

/// The tiles and triangles of a `sparse` asset.
struct ElementChoice {
  std::vector<TileData> tiles;
  std::vector<SurfacePiece> triangles;  ///< whole ones, and pieces
  double triangle_area_share = 0;       ///< share of the surface that triangles represent
};

/// Chooses which tiles are worth their bytes; `cover` says which tiles cover what of the surface.
/// Where a tile covers few triangles of the surface, or leaves many pieces uncovered, the triangles
/// themselves take fewer bytes. Tiles are dropped in the order of how little surface they leave to
/// triangles for a byte that is saved. This goes on until triangles represent `free_share` of the
/// surface, or more where bytes are many.
[[nodiscard]] ElementChoice choose_elements(const Caster& caster, std::vector<TileData> tiles,
                                            const SurfaceCover& cover, double free_share);

/// A node of the BVH is 40 bytes. Replacing one child by four adds one node.
inline constexpr std::uint64_t bvh_bytes = 14;
/// Bytes that a tile takes in a file, together with its share of the BVH.
[[nodiscard]] std::uint64_t tile_bytes(const TileData& tile);
/// The same for a triangle.
inline constexpr std::uint64_t triangle_bytes = 13;

}  // namespace spm::baker
