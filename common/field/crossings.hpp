// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "common/base/octant.hpp"
#include "common/base/vector.hpp"
#include "common/field/triangle_list.hpp"

namespace spm {

/// A place of known side is at least so much of half its cube's edge away from the surface.
inline constexpr double known_place_room = 1.0 / 16;

/// A place of a cube, by its corner's octant or eight for the middle. The middle and half the edge
/// in metres.
[[nodiscard]] inline Vector3 place_of_cube(const Vector3& middle, double half,
                                           std::uint32_t place) noexcept {
  return place < 8 ? Vector3(middle + half * octant_direction(place)) : middle;
}

/// By how much the winding number of triangles at a point is above that at the end of a way from
/// there. Nothing where the way passes so close to a side that rounding would decide. The k-th of
/// `count` triangles is `corners(k)`, an array of three vectors.
template <class Corners>
[[nodiscard]] std::optional<int> winding_change(std::size_t count, const Corners& corners,
                                                const Vector3& point, const Vector3& way) noexcept {
  // Of a product of three vectors, so much of their lengths' product may be rounding.
  constexpr double rounding = 1e-14;
  int change = 0;
  const double length = way.squaredNorm();
  for (std::size_t k = 0; k < count; ++k) {
    const std::array<Vector3, 3> triangle = corners(k);
    const Vector3 a = triangle[0] - point, b = triangle[1] - point, c = triangle[2] - point;
    const double at_a = a.dot(way), at_b = b.dot(way), at_c = c.dot(way);
    if (std::max({at_a, at_b, at_c}) < 0 || std::min({at_a, at_b, at_c}) > length) continue;
    // Each is that of a side, and of the opposite sign in the triangle across it, bit by bit.
    const double u = way.dot(b.cross(c)), v = way.dot(c.cross(a)), w = way.dot(a.cross(b));
    const double least = std::min({u, v, w}), most = std::max({u, v, w});
    const double size = std::max({a.squaredNorm(), b.squaredNorm(), c.squaredNorm()});
    const double unsure = rounding * size * std::sqrt(length);
    if (least < -unsure && most > unsure) continue;
    if (least <= unsure && most >= -unsure) return std::nullopt;
    const double sum = u + v + w, place = (u * at_a + v * at_b + w * at_c) / sum;
    if (place > 0 && place < length) change += sum > 0 ? 1 : -1;
  }
  return change;
}

/// Whether a point of a cube is inside by the crossings of closed surfaces, of which these
/// triangles are all that pass the cube: by ways from a place of known side. Nothing where each way
/// comes too close to a side of a triangle.
template <class Corners>
[[nodiscard]] std::optional<bool> is_surrounded(std::size_t count, const Corners& corners,
                                                const KnownPlace& known, const Vector3& middle,
                                                double half, const Vector3& point) noexcept {
  // Ways begin at the known place, or so far from it, of known_place_room along each axis into the
  // cube.
  constexpr std::array<std::array<double, 3>, 5> starts{
      {{0, 0, 0}, {0.5, 0.35, 0.2}, {0.2, 0.45, 0.5}, {0.3, 0.15, 0.55}, {0.45, 0.5, 0.1}}};
  const Vector3 place = place_of_cube(middle, half, known.place);
  const Vector3 inward =
      known.place < 8 ? Vector3(-octant_direction(known.place)) : Vector3::Ones();
  for (const auto& [x, y, z] : starts) {
    const Vector3 start = known_place_room * half * inward.cwiseProduct(Vector3(x, y, z));
    if (const auto change = winding_change(count, corners, point, place + start - point)) {
      return *change + (known.inside ? 1 : 0) > 0;
    }
  }
  return std::nullopt;
}

}  // namespace spm
