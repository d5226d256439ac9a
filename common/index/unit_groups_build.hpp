// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "common/asset/asset_view.hpp"

namespace spm {

/// All packets of an asset's primitives, and what the index's builder needs to know of the
/// primitives.
struct UnitGroupsData {
  std::vector<CellGroup> cells;
  std::vector<ClipGroup> clips;
  std::vector<TriangleGroup> triangles;
  /// Outward, unit, of each unit, `group_units` a group; 0 where there is none or it tells no side.
  std::vector<Vector3> normals;
  std::uint32_t first_cap = 0;  ///< groups from this number on are of caps alone, others have none
  double usual_width = 0;  ///< of two cells, or a triangle where there are no tiles: the median, m

  [[nodiscard]] UnitGroups view() const noexcept { return {cells, clips, triangles}; }
  [[nodiscard]] std::size_t size() const noexcept { return cells.size() + triangles.size(); }
};

/// Gathers the units of a `sparse` asset into groups of such as lie near each other. Allocates.
[[nodiscard]] UnitGroupsData gather_unit_groups(const AssetView& asset);

}  // namespace spm
