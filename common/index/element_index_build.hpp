// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/asset/asset_view.hpp"

namespace spm {

/// The memory that an ElementIndex points into.
struct ElementIndexData {
  Vector3 origin = Vector3::Zero();
  double cell_size = 1;
  std::array<std::uint32_t, 3> cells{0, 0, 0};
  std::vector<std::uint32_t> words;
  double slack = 0;
  std::vector<CellGroup> cell_groups;
  std::vector<ClipGroup> clip_groups;
  std::vector<TriangleGroup> triangle_groups;

  [[nodiscard]] ElementIndex view() const noexcept {
    return {origin,
            cell_size,
            1 / cell_size,
            cells,
            words,
            slack,
            {cell_groups, clip_groups, triangle_groups}};
  }
  [[nodiscard]] std::size_t bytes() const noexcept {
    return 4 * words.size() + sizeof(CellGroup) * cell_groups.size() +
           sizeof(ClipGroup) * clip_groups.size() + sizeof(TriangleGroup) * triangle_groups.size();
  }
};

/// Builds the index of a `sparse` asset from its trees. Wherever the surface is within the band,
/// the list of a cube names every element that can matter to a point of the cube. Allocates: for
/// the loading thread. Empty for an asset that is not `sparse`.
[[nodiscard]] ElementIndexData build_element_index(const AssetView& asset);

}  // namespace spm
