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

/// The surface of a `sparse` asset as its answers tell it: where lines along the three axes, at
/// most `step` (m, above 0) apart, meet it. A line stands for an area a of its cross-section, and
/// so for a / |n| of the surface; that of each family counts by n^2, n the normal's component along
/// the line, and the squares add up to 1. So the areas of all are a |n|, and add up to the
/// surface's. Allocates: for loading, not for a tick. Errors: invalid_input for a `full` asset,
/// whose maps cover a place many times, for one without a surface, and where there would be more
/// than 2^24 lines; usage where there is no step.
[[nodiscard]] Result<std::vector<SurfacePatch>> surface_patches(const AssetView& asset,
                                                                double step);

}  // namespace spm
