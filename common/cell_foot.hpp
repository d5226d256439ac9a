// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/tile.hpp"

namespace spm {

/// Bilinear patch of a cell about its middle, and a point relative to that middle.
struct CellPatch {
  float slope_x, slope_y, twist;  ///< twist: h00 - h10 - h01 + h11, over the spacing squared
  float dx, dy, dz;

  [[nodiscard]] float height(float x, float y) const noexcept {
    return slope_x * x + slope_y * y + twist * x * y;
  }
  [[nodiscard]] float squared_distance(float x, float y) const noexcept {
    const float below = dz - height(x, y);
    return (dx - x) * (dx - x) + (dy - y) * (dy - y) + below * below;
  }
};

/// Moves a foot (from the cell's middle) that a clip line leaves out to the line; false where
/// nothing of the cell is left. All lengths in the unit of `spacing`.
[[nodiscard]] bool clip_foot(const CellPatch& cell, const Clip& clip, float spacing, float& x,
                             float& y) noexcept;

/// Fills what follows from where the foot is: its distance (m), and how far the point is below.
void settle_foot(TileFoot& foot, float distance) noexcept;

}  // namespace spm
