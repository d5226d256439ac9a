// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>

#include "common/field/octree_leaves.hpp"
#include "common/query/query.hpp"
#include "formats/asset/asset.hpp"

namespace spm::test {

/// Moves the answers of the leaves with distance maps that `which` tells by this many metres: they
/// get maps of their own.
template <class Which>
void raise_maps(Asset& asset, double by, const Which& which) {
  AtlasData& atlas = asset.atlas;
  atlas.halves = false;
  const auto charts = static_cast<std::uint32_t>(atlas.charts.size());
  const auto heights = static_cast<std::uint32_t>(atlas.heights.size());
  const AssetTables tables = tables_of(asset);
  visit_leaves(tables.view().octree, [&](const Leaf& leaf) {
    if (leaf.kind != OctreeKind::map || !which(leaf)) return;
    std::uint32_t& word = asset.octree.words[leaf.word];
    word += NamedMaps(word).two() ? charts << 16U | charts : charts;
  });
  for (std::uint32_t k = 0; k < charts; ++k) {
    ChartData chart = atlas.charts[k];
    chart.first += heights;
    atlas.charts.push_back(chart);
  }
  for (std::uint32_t k = 0; k < heights; ++k) {
    atlas.heights.push_back(atlas.heights[k] + static_cast<float>(by));
  }
}

/// Moves the answers of the largest leaf with one distance map near the surface of a `sparse` asset
/// by this many metres, and gives the leaf.
[[nodiscard]] inline Leaf spoil_largest_map(Asset& asset, double by) {
  const AssetTables tables = tables_of(asset);
  Leaf largest;
  visit_leaves(tables.view().octree, [&](const Leaf& leaf) {
    const std::uint32_t* words = words_at(tables.view().octree, leaf);
    if (leaf.kind != OctreeKind::map || NamedMaps(words[0]).two()) return;
    const double distance = query_point(tables.view(), leaf.middle).distance;
    if (std::abs(distance) < leaf.half && leaf.half > largest.half) largest = leaf;
  });
  REQUIRE(largest.half > 0);
  raise_maps(asset, by, [&](const Leaf& leaf) { return leaf.word == largest.word; });
  return largest;
}

}  // namespace spm::test
