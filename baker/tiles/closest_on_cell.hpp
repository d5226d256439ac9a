// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "common/surface/tile.hpp"

namespace spm::baker {

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

/// Moves a closest point (from the cell's middle) that a clip line excludes onto the line. False
/// where nothing of the cell is left. All lengths in units of `spacing`.
[[nodiscard]] bool clip_closest_point(const CellPatch& cell, const Clip& clip, float spacing,
                                      float& x, float& y) noexcept;

}  // namespace spm::baker
