// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>

#include "common/field/octree_leaves.hpp"
#include "common/query/query.hpp"
#include "formats/asset/asset.hpp"

namespace spm::test {

/// Moves the answers of the largest leaf with one distance map near the surface of a `sparse` asset
/// by about this many metres, and gives the leaf: it gets a map of its own.
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
  std::uint32_t& word = asset.octree.words[largest.word];
  AtlasData& atlas = asset.atlas;
  ChartData chart = atlas.charts[NamedMaps(word).first];
  std::vector<float> heights(std::size_t{chart.rows} * atlas.width, 0);
  for (std::uint32_t row = 0; row < chart.rows; ++row) {
    for (std::uint32_t column = 0; column < chart.columns; ++column) {
      heights[std::size_t{row} * atlas.width + column] =
          atlas.heights[chart.first + std::size_t{row} * atlas.width + column] +
          static_cast<float>(by);
    }
  }
  chart.first = static_cast<std::uint32_t>(atlas.heights.size());
  heights.resize(heights.size() + atlas.width, 0);  // one more is read behind the last
  atlas.heights.insert(atlas.heights.end(), heights.begin(), heights.end());
  word = word_of_map(static_cast<std::uint32_t>(atlas.charts.size()));
  atlas.charts.push_back(chart);
  return largest;
}

}  // namespace spm::test
