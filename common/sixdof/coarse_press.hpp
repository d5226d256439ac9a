// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace spm {

/// Half the extent of what a square of the finest samples represents, over its side. Half of the
/// side would count what its neighbours represent, where the surface bends. Chosen with the numbers
/// of object_quadrature.cpp.
inline constexpr double square_half = 0.25;

/// Depth of a patch whose parts are spread evenly between `depth - half` and `depth + half`: mean
/// and mean square over the part below the surface, and the size of that part.
struct CoarsePress {
  double depth = 0, square = 0, share = 0;
};
[[nodiscard]] inline CoarsePress coarse_press(double depth, double half) noexcept {
  if (depth >= half) return {depth, depth * depth + half * half / 3, 1};
  if (!(depth > -half)) return {};
  const double below = depth + half;
  const double share = below / (2 * half);
  return {below / 2 * share, below * below / 3 * share, share};
}

}  // namespace spm
