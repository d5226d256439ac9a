// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/proof/tile_bins.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// A tile or fan of triangles with its box.
struct TreeElement {
  Box box;
  std::uint32_t number = 0;
  std::uint32_t triangles = 0;  ///< of a fan; 0: a tile
  bool cap = false;             ///< a fan of caps
};

/// The tree over elements, which it numbers anew in the order of its leaves: what lies together in
/// space lies together in the file.
struct BuiltTree {
  TreeData data;
  std::vector<std::uint32_t> tiles;  ///< the old number of each
  std::vector<std::uint32_t> fans;   ///< likewise, caps last
  std::uint32_t first_cap = 0;       ///< corner that caps begin at
};

/// Builds the tree, splitting where boxes get smallest (surface area heuristic). The same for the
/// same elements in the same order. Throws BakeError where they are more than a file can name.
[[nodiscard]] BuiltTree build_tree(const std::vector<TreeElement>& elements);

}  // namespace spm::baker
