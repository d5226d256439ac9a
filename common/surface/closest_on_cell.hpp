// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/surface/closest_on_tile.hpp"
#include "common/surface/tile.hpp"

namespace spm {

/// Bilinear patch of a cell, and a point; both relative to the middle of the cell.
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

/// Finds the closest point on the mean plane over the unclipped cell, with the spacing as the unit;
/// its height is then taken from the bilinear patch. Exact, except for points beyond two adjacent
/// sides of a cell that is steep in both directions: there the result is near the closest point.
void closest_on_patch(const CellPatch& cell, float& x, float& y) noexcept;

/// The part of a clip line that crosses a cell, from the cell's middle, with the spacing as the
/// unit.
struct ClipSegment {
  float x, y, to_x, to_y;  ///< from (x, y) to (x + to_x, y + to_y)
};

/// False where the line does not cross the cell.
[[nodiscard]] bool clip_segment(const Clip& clip, ClipSegment& segment) noexcept;

/// Moves a closest point (from the cell's middle) that a clip line excludes onto the line. False
/// where nothing of the cell is left. All lengths in units of `spacing`.
[[nodiscard]] bool clip_closest_point(const CellPatch& cell, const Clip& clip, float spacing,
                                      float& x, float& y) noexcept;

/// Fills in what follows from the position of the closest point: its distance (m), and how far the
/// query point is below the surface.
void settle_closest_point(TileClosestPoint& closest_point, float distance) noexcept;

}  // namespace spm
