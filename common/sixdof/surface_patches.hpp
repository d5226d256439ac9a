// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "common/asset/asset_view.hpp"
#include "common/base/error.hpp"

namespace spm {

/// A small piece of a surface; the asset's frame, metres.
struct SurfacePatch {
  std::array<float, 3> position{};  ///< its middle
  std::array<float, 3> normal{};    ///< unit, out of the solid
  float area = 0;                   ///< m2
};

/// The surface of a `sparse` asset in pieces with sides of at most `step` (m, above 0). Where
/// elements overlap, each place belongs to one of them only: the first that covers it within two
/// tolerances and faces the same way, with the triangles first, in the order of their corners, and
/// then the tiles. So the areas add up to that of the surface, however many elements there are.
/// Allocates: for loading, not for a tick. Errors: invalid_input for a `full` asset, whose maps
/// cover a place many times, for one without elements, and where there would be more than 2^24
/// pieces and 64 an element; usage for one whose tiles were left out.
[[nodiscard]] Result<std::vector<SurfacePatch>> surface_patches(const AssetView& asset,
                                                                double step);

}  // namespace spm
