// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/proof/tile_bins.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// A tile or a fan of triangles, with its box.
struct BvhElement {
  Box box;
  std::uint32_t number = 0;
  std::uint32_t triangles = 0;  ///< of a fan; 0: a tile
  bool cap = false;             ///< a fan of caps
};

/// The bounding volume hierarchy (BVH) over elements. It numbers the elements anew in the order of
/// its leaves, so that neighbours in space are neighbours in the file.
struct BuiltBvh {
  BvhData data;
  std::vector<std::uint32_t> tiles;  ///< old number of each tile
  std::vector<std::uint32_t> fans;   ///< old number of each fan, caps last
  std::uint32_t first_cap = 0;       ///< the corner at which caps begin
};

/// Builds the BVH. It splits where boxes become smallest (surface area heuristic). The same
/// elements in the same order give the same tree. Throws BakeError where there are more elements
/// than a file can name.
[[nodiscard]] BuiltBvh build_bvh(const std::vector<BvhElement>& elements);

}  // namespace spm::baker
