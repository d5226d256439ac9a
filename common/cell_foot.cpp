// SPDX-License-Identifier: Apache-2.0
#include "common/cell_foot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spm {

bool clip_foot(const CellPatch& cell, const Clip& clip, float spacing, float& x,
               float& y) noexcept {
  if (clip.a * x + clip.b * y <= clip.c * spacing) return true;
  const float square = clip.a * clip.a + clip.b * clip.b;
  if (!(square > 0)) return false;
  const float x0 = clip.a * clip.c * spacing / square, y0 = clip.b * clip.c * spacing / square;
  const float along_x = -clip.b, along_y = clip.a;
  const float half = spacing / 2;
  float from = -std::numeric_limits<float>::infinity(), to = -from;
  if (along_x != 0) {
    const float one = (-half - x0) / along_x, other = (half - x0) / along_x;
    from = std::max(from, std::min(one, other));
    to = std::min(to, std::max(one, other));
  } else if (std::abs(x0) > half) {
    return false;
  }
  if (along_y != 0) {
    const float one = (-half - y0) / along_y, other = (half - y0) / along_y;
    from = std::max(from, std::min(one, other));
    to = std::min(to, std::max(one, other));
  } else if (std::abs(y0) > half) {
    return false;
  }
  if (!(from <= to)) return false;
  const float along_z = cell.slope_x * along_x + cell.slope_y * along_y;
  const float z0 = cell.slope_x * x0 + cell.slope_y * y0;
  const float t = ((cell.dx - x0) * along_x + (cell.dy - y0) * along_y + (cell.dz - z0) * along_z) /
                  (square + along_z * along_z);
  const float place = std::clamp(t, from, to);
  x = x0 + place * along_x;
  y = y0 + place * along_y;
  return true;
}

void settle_foot(TileFoot& foot, float distance) noexcept {
  foot.distance = distance;
  const float level =
      std::sqrt(1 + foot.slope_eta * foot.slope_eta + foot.slope_omega * foot.slope_omega);
  foot.below =
      (foot.away_depth - foot.slope_eta * foot.away_eta - foot.slope_omega * foot.away_omega) /
      level;
}

}  // namespace spm
