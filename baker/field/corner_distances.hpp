// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/base/vector.hpp"

namespace spm::baker {

/// A value at each corner of a cube, in the order of the octants (octant.hpp).
using CornerValues = Eigen::Array<double, 8, 1>;

/// A function that is linear over a cube, at its corners: `value` at the middle, `rise` from there
/// to each face, axis by axis.
[[nodiscard]] CornerValues linear_at_corners(double value, const Vector3& rise);

/// Distances of a triangle from the corners of the cube of that middle and half edge, m; never
/// below the exact ones by more than the rounding of doubles. Within the cube the distance is at
/// most what these give in between, since it is convex.
[[nodiscard]] CornerValues corner_distances(const std::array<Vector3, 3>& triangle,
                                            const Vector3& middle, double half);

/// The same, and the vectors to the corners from the closest points of the triangle, axis by axis.
struct CornerVectors {
  CornerValues distances;
  std::array<CornerValues, 3> away;
};
[[nodiscard]] CornerVectors corner_vectors(const std::array<Vector3, 3>& triangle,
                                           const Vector3& middle, double half);

/// A function that is linear over a cube, as linear_at_corners takes it.
struct LinearFunction {
  double value = 0;
  Vector3 rise = Vector3::Zero();
};

/// For each function whether some of the values are below it at all corners, each as far as it
/// goes: 1, or else 0.
void find_above(std::span<const LinearFunction> functions, std::span<const CornerValues> values,
                std::vector<std::uint8_t>& above);

}  // namespace spm::baker
