// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/asset_view.hpp"
#include "common/element_units.hpp"

namespace spm {

/// Orders units so that those of each group lie near each other.
void order_by_place(std::span<ElementUnit> units);

/// The groups of units in their order, which are blocks of tiles. Allocates.
[[nodiscard]] std::vector<BoxGroup> box_groups(const AssetView& asset,
                                               std::span<const ElementUnit> blocks);

/// The groups of units in their order, which are triangles. Allocates.
[[nodiscard]] std::vector<TriangleGroup> triangle_groups(const AssetView& asset,
                                                         std::span<const ElementUnit> triangles);

}  // namespace spm
