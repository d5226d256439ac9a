// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "common/asset_view.hpp"
#include "common/oriented_box.hpp"

namespace spm {

/// A part of an element that a box bounds: a block of 2 x 2 cells of a tile, named by its quarter,
/// or a triangle.
struct ElementUnit {
  IndexUnit name;
  OrientedBox box;
  std::vector<Vector3> normals;  ///< outward, of its cells, or the triangle's
  bool cap = false;
};

/// The parts of an element that have surface. Allocates.
[[nodiscard]] std::vector<ElementUnit> units_of(const AssetView& asset, const TreeChild& element);

}  // namespace spm
