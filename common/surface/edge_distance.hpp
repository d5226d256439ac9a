// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace spm {

/// A distance from two surfaces that meet at an edge, and by how much it grows with the distance
/// from each.
struct EdgeDistance {
  double distance = 0;  ///< m
  double first = 0, second = 0;
};

/// The distance in front of a convex edge: from the surface whose plane is farther, or, where a
/// place's feet on both planes lie past it, from the edge itself, in closed form. `first` and
/// `second` are the distances from both planes, m, below 0 behind them; `cosine` is that between
/// their unit normals. The direction from what is nearest is first n1 + second n2, of length 1.
/// Behind a concave edge the same holds of all distances' negatives.
[[nodiscard]] inline EdgeDistance edge_distance(double first, double second,
                                                double cosine) noexcept {
  constexpr double least_sine_square = 1e-6;  // below it the edge is no farther than 1 part in 10^6
  const double sine_square = 1 - cosine * cosine;
  const bool is_first = first >= second;
  const double farther = is_first ? first : second, other = is_first ? second : first;
  if (!(farther > 0 && other > cosine * farther && sine_square > least_sine_square)) {
    return {farther, is_first ? 1.0 : 0.0, is_first ? 0.0 : 1.0};
  }
  const double past_first = first - cosine * second, past_second = second - cosine * first;
  const double square = first * past_first + second * past_second;
  const double per = 1 / std::sqrt(square * sine_square);
  return {per * square, per * past_first, per * past_second};
}

}  // namespace spm
