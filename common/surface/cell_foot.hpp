// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/surface/closest_on_tile.hpp"
#include "common/surface/tile.hpp"

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

/// Finds the foot on the mean plane over the cell, whole, with the spacing as the unit; its height
/// is then the patch's own. Exact but for points that are beyond two sides that meet, of a cell
/// that is steep both ways: there it is near the nearest.
void closest_on_patch(const CellPatch& cell, float& x, float& y) noexcept;

/// Where a clip line crosses a cell, from its middle, with the spacing as the unit.
struct ClipSegment {
  float x, y, to_x, to_y;  ///< from (x, y) to (x + to_x, y + to_y)
};

/// False where the line does not cross the cell.
[[nodiscard]] bool clip_segment(const Clip& clip, ClipSegment& segment) noexcept;

/// Moves a foot (from the cell's middle) that a clip line leaves out to the line; false where
/// nothing of the cell is left. All lengths in the unit of `spacing`.
[[nodiscard]] bool clip_foot(const CellPatch& cell, const Clip& clip, float spacing, float& x,
                             float& y) noexcept;

/// Fills what follows from where the foot is: its distance (m), and how far the point is below.
void settle_foot(TileFoot& foot, float distance) noexcept;

}  // namespace spm
