// SPDX-License-Identifier: GPL-3.0-or-later
// Distances at the corners of a cube, all eight at once.
#include "baker/field/corner_distances.hpp"

#include <catch2/catch.hpp>

#include "common/base/octant.hpp"
#include "common/base/random.hpp"
#include "common/surface/closest_on_triangle.hpp"

namespace spm::baker::corner_distances_test {
namespace {

Vector3 random_place(std::uint64_t i) {
  return {random_unit(3, 3 * i) - 0.5, random_unit(3, 3 * i + 1) - 0.5,
          random_unit(3, 3 * i + 2) - 0.5};
}

/// A triangle by seed; each fourth one has no area.
std::array<Vector3, 3> random_triangle(std::uint64_t i) {
  std::array<Vector3, 3> corners{random_place(4 * i), random_place(4 * i + 1),
                                 random_place(4 * i + 2)};
  if (i % 4 == 3) corners[2] = corners[0] + random_unit(4, i) * (corners[1] - corners[0]);
  return corners;
}

}  // namespace

TEST_CASE("The corners of a cube get the distances and directions that each gets alone") {
  constexpr std::uint64_t triangles = 4000;
  for (std::uint64_t i = 0; i < triangles; ++i) {
    const std::array<Vector3, 3> corners = random_triangle(i);
    const Vector3 middle = random_place(4 * i + 3);
    const double half = 0.3 * random_unit(5, i);
    const TriangleShares shares = shares_of(corners);
    const CornerTangents found = corner_tangents(corners, shares, middle, half);
    const CornerValues distances = corner_distances(corners, shares, middle, half);
    for (std::size_t k = 0; k < 8; ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      const Vector3 corner = middle + half * octant_direction(k);
      const Vector3 away = corner - closest_on_triangle(corner, corners[0], corners[1], corners[2]);
      REQUIRE(std::abs(found.distances[at] - away.norm()) < 1e-12);
      REQUIRE(distances[at] == found.distances[at]);
      const Vector3 told(found.tangents[0][at], found.tangents[1][at], found.tangents[2][at]);
      REQUIRE((away.norm() * told - away).norm() < 1e-9);
    }
  }
}

}  // namespace spm::baker::corner_distances_test
