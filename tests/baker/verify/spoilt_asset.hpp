// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>

#include "common/field/octree_leaves.hpp"
#include "common/query/query.hpp"
#include "formats/asset/asset.hpp"

namespace spm::test {

/// Moves the answers of the largest polynomial near the surface of a `sparse` asset by this many
/// metres, and gives its leaf.
[[nodiscard]] inline Leaf spoil_largest_polynomial(Asset& asset, double by) {
  const AssetTables tables = tables_of(asset);
  Leaf largest;
  visit_leaves(tables.view().octree, [&](const Leaf& leaf) {
    const double distance = query_point(tables.view(), leaf.middle).distance;
    const bool near = std::abs(distance) < leaf.half;
    if (leaf.kind == OctreeKind::polynomial && near && leaf.half > largest.half) largest = leaf;
  });
  REQUIRE(largest.half > 0);
  // The value is the lower half of a polynomial's first word.
  std::uint32_t& word = asset.octree.units[2 * std::size_t{largest.unit}];
  const auto steps = static_cast<std::uint32_t>(std::lround(by / asset.octree.value_unit));
  word = (word & 0xFFFF0000U) | ((word + steps) & 0xFFFFU);
  return largest;
}

}  // namespace spm::test
