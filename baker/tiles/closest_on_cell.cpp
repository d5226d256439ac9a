// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/tiles/closest_on_cell.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spm::baker {

namespace {

/// The part of a clip line that crosses a cell, from the cell's middle, with the spacing as the
/// unit.
struct ClipSegment {
  float x, y, to_x, to_y;  ///< from (x, y) to (x + to_x, y + to_y)
};

/// False where the line does not cross the cell.
bool clip_segment(const Clip& clip, ClipSegment& segment) noexcept {
  const float square = clip.a * clip.a + clip.b * clip.b;
  if (!(square > 0)) return false;
  const float x0 = clip.a * clip.c / square, y0 = clip.b * clip.c / square;
  const float along_x = -clip.b, along_y = clip.a;
  constexpr float half = 0.5F;
  float from = -std::numeric_limits<float>::infinity(), to = -from;
  const auto keep_within = [&](float start, float along) {
    if (along == 0) return std::abs(start) <= half;
    const float one = (-half - start) / along, other = (half - start) / along;
    from = std::max(from, std::min(one, other));
    to = std::min(to, std::max(one, other));
    return true;
  };
  if (!keep_within(x0, along_x) || !keep_within(y0, along_y)) return false;
  if (!(from <= to)) return false;
  segment = {x0 + from * along_x, y0 + from * along_y, (to - from) * along_x,
             (to - from) * along_y};
  return true;
}

}  // namespace

bool clip_closest_point(const CellPatch& cell, const Clip& clip, float spacing, float& x,
                        float& y) noexcept {
  if (clip.a * x + clip.b * y <= clip.c * spacing) return true;
  ClipSegment segment{};
  if (!clip_segment(clip, segment)) return false;
  const float x0 = segment.x * spacing, y0 = segment.y * spacing;
  const float to_x = segment.to_x * spacing, to_y = segment.to_y * spacing;
  const float to_z = cell.slope_x * to_x + cell.slope_y * to_y;
  const float z0 = cell.slope_x * x0 + cell.slope_y * y0;
  const float square = to_x * to_x + to_y * to_y + to_z * to_z;
  const float along = (cell.dx - x0) * to_x + (cell.dy - y0) * to_y + (cell.dz - z0) * to_z;
  const float share = square > 0 ? std::clamp(along / square, 0.0F, 1.0F) : 0.0F;
  x = x0 + share * to_x;
  y = y0 + share * to_y;
  return true;
}

}  // namespace spm::baker
