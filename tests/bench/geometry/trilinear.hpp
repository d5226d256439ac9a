// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "common/query/query.hpp"

namespace spm::bench {

/// Signed distances at a cube's corners, metres; bit 0 of the index is x, bit 1 y, bit 2 z.
using CubeCorners = std::array<float, 8>;

/// A place in a cube, each coordinate from 0 to 1.
using CubePlace = std::array<float, 3>;

/// Distance at a place in the cube, in floats as it is stored. The normal is the direction of the
/// gradient of the trilinear function.
[[nodiscard]] inline Answer trilinear(const CubeCorners& corners, const CubePlace& place) noexcept {
  // One by one: read as vectors, corners just stored one by one would have to be waited for.
  const auto mix = [](float a, float b, float t) { return a + t * (b - a); };
  const auto [x, y, z] = place;
  const auto& [c0, c1, c2, c3, c4, c5, c6, c7] = corners;
  const float x0 = c1 - c0, x1 = c3 - c2, x2 = c5 - c4, x3 = c7 - c6;
  const float a0 = c0 + x * x0, a1 = c2 + x * x1, a2 = c4 + x * x2, a3 = c6 + x * x3;
  const float y0 = a1 - a0, y1 = a3 - a2;
  const float near = a0 + y * y0, far = a2 + y * y1;
  const float gx = mix(mix(x0, x1, y), mix(x2, x3, y), z);
  const float gy = mix(y0, y1, z), gz = far - near;
  Answer answer;
  answer.distance = near + z * gz;
  const float squared = gx * gx + gy * gy + gz * gz;
  if (squared > 0) {
    const float scale = 1 / std::sqrt(squared);
    answer.normal = Vector3(gx * scale, gy * scale, gz * scale);
  }
  answer.status = Status::exact;
  return answer;
}

/// Answer for a point deeper than the band: `deep`, with only the depth of the band.
[[nodiscard]] inline Answer deep_answer(double max_depth) noexcept {
  Answer answer;
  answer.distance = -max_depth;
  answer.status = Status::deep;
  return answer;
}

/// Answer for a point outside, beyond the margin.
[[nodiscard]] inline Answer far_answer() noexcept { return unanswered(Status::far); }

}  // namespace spm::bench
