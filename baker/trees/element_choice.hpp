// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/proof/surface_proof.hpp"

namespace spm::baker {

/// What a `sparse` asset is made of.
struct ElementChoice {
  std::vector<TileData> tiles;
  std::vector<SurfacePiece> triangles;  ///< whole ones, and pieces
  double triangle_area_share = 0;       ///< of the surface that triangles stand for
};

/// Chooses, out of tiles that stand for the surface as `cover` tells, those that are worth their
/// bytes. Where a tile stands for few triangles of the surface, or leaves many pieces open, the
/// triangles themselves are fewer bytes. Tiles go in the order of how little surface they leave to
/// triangles for a byte that is saved; until triangles stand for `free_share` of the surface, or
/// more where bytes are many.
[[nodiscard]] ElementChoice choose_elements(const Caster& caster, std::vector<TileData> tiles,
                                            const SurfaceCover& cover, double free_share);

/// A node of the tree of elements is 40 bytes, and four children in place of one add one.
inline constexpr std::uint64_t tree_bytes = 14;
/// Bytes that a tile takes in a file, and its share of that tree.
[[nodiscard]] std::uint64_t tile_bytes(const TileData& tile);
/// Bytes of a triangle likewise.
inline constexpr std::uint64_t triangle_bytes = 13;

}  // namespace spm::baker
