// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <limits>

#include "common/query/query.hpp"

namespace spm::bench {

/// Signed distances at a cube's corners, metres; bit 0 of the index is x, bit 1 y, bit 2 z.
using CubeCorners = std::array<double, 8>;

/// Distance at a place in the cube, each coordinate from 0 to 1. The normal is the direction of the
/// gradient of the trilinear function.
[[nodiscard]] inline Answer trilinear(const CubeCorners& corners, const Vector3& place) noexcept {
  const auto mix = [](double a, double b, double t) { return a + t * (b - a); };
  std::array<double, 4> along_x{}, slope_x{};
  for (std::size_t i = 0; i < 4; ++i) {
    along_x[i] = mix(corners[2 * i], corners[2 * i + 1], place.x());
    slope_x[i] = corners[2 * i + 1] - corners[2 * i];
  }
  const std::array<double, 2> along_y{mix(along_x[0], along_x[1], place.y()),
                                      mix(along_x[2], along_x[3], place.y())};
  Answer answer;
  answer.distance = mix(along_y[0], along_y[1], place.z());
  const Vector3 gradient(mix(mix(slope_x[0], slope_x[1], place.y()),
                             mix(slope_x[2], slope_x[3], place.y()), place.z()),
                         mix(along_x[1] - along_x[0], along_x[3] - along_x[2], place.z()),
                         along_y[1] - along_y[0]);
  const double length = gradient.norm();
  if (length > 0) answer.normal = gradient / length;
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
[[nodiscard]] inline Answer far_answer() noexcept {
  Answer answer;
  answer.distance = std::numeric_limits<double>::quiet_NaN();
  answer.status = Status::far;
  return answer;
}

}  // namespace spm::bench
