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

/// What distances from a triangle are computed with, beside its corners a, b and c: its divisions,
/// which take longer than the rest.
struct TriangleShares {
  /// The share of b, and of c, at a projection is that of the vector from a along this; 1/m.
  Vector3 to_b = Vector3::Zero(), to_c = Vector3::Zero();
  double per_ab = 0, per_ac = 0, per_bc = 0;  ///< 1 / m^2, of the squares of the sides, or 0
  bool flat = true;                           ///< without an area
};
[[nodiscard]] TriangleShares shares_of(const std::array<Vector3, 3>& triangle);

/// Distances of a triangle from the corners of the cube of that middle and half edge, m; never
/// below the exact ones by more than the rounding of doubles. Within the cube the distance is at
/// most what these give in between, since it is convex.
[[nodiscard]] CornerValues corner_distances(const std::array<Vector3, 3>& triangle,
                                            const TriangleShares& shares, const Vector3& middle,
                                            double half);

/// The same, and how they rise at the corners, axis by axis: unit vectors away from the closest
/// points of the triangle, or 0 where it passes.
struct CornerTangents {
  CornerValues distances;
  std::array<CornerValues, 3> tangents;
};
[[nodiscard]] CornerTangents corner_tangents(const std::array<Vector3, 3>& triangle,
                                             const TriangleShares& shares, const Vector3& middle,
                                             double half);

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
