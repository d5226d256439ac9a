// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/surface_distance.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>

#include "tests/support/random.hpp"
#include "tests/support/shapes.hpp"

namespace spm::baker::surface_distance_test {
namespace {

constexpr double enough = 1e-6;

[[nodiscard]] OuterSurface as_surface(const test::Shape& shape) {
  OuterSurface surface;
  surface.vertices = shape.vertices;
  surface.triangles = shape.triangles;
  surface.solid_count = surface.triangles.size();
  return surface;
}

/// A square of edge 2 at a height, in triangles around a corner inside.
[[nodiscard]] test::Shape square(double x, double y, double z) {
  return {{{-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z}, {x, y, z}},
          {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}};
}

}  // namespace

TEST_CASE("A surface in other triangles is no distance away, and one beside it its distance") {
  const OuterSurface one = as_surface(square(0.1, 0.2, 0));
  CHECK(largest_distance(one, Caster(one), enough) <= enough);
  for (const double height : {0.0, 1e-5, 1e-3}) {
    const OuterSurface other = as_surface(square(-0.7, 0.33, height));
    CHECK(largest_distance(one, Caster(other), enough) == Approx(height).margin(2 * enough));
    CHECK(largest_distance(other, Caster(one), enough) == Approx(height).margin(2 * enough));
  }
}

TEST_CASE("What another surface does not have is as far away as it stands out") {
  const test::Shape cube = test::box({1, 1, 1});
  const OuterSurface with = as_surface(test::merged(cube, test::box({0.1, 0.1, 1.2})));
  const double there = largest_distance(with, Caster(as_surface(cube)), enough);
  // Inside the cube the other part is up to 0.45 from its sides.
  CHECK(there >= 0.45 - enough);
  CHECK(there <= 1.5 * 0.45 + enough);
  CHECK(largest_distance(as_surface(cube), Caster(with), enough) <= enough);
}

TEST_CASE("No place of a moved surface is farther than the bound, and it is no more than twice") {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    test::RandomTwister random(seed);
    test::Shape moved = test::sphere(1, 2);
    const OuterSurface still = as_surface(moved);
    for (Vector3& vertex : moved.vertices) vertex += 1e-3 * random.unit() * random.direction();
    const OuterSurface other = as_surface(moved);
    const Caster caster(still);
    const double bound = largest_distance(other, caster, enough);
    double most = 0;
    for (const auto& [a, b, c] : other.triangles) {
      for (int i = 0; i < 10; ++i) {
        const double u = random.unit(), v = random.unit() * (1 - u);
        const Vector3 place = other.vertices[a] + u * (other.vertices[b] - other.vertices[a]) +
                              v * (other.vertices[c] - other.vertices[a]);
        most = std::max(most, (caster.closest(place).closest_point - place).norm());
      }
    }
    CHECK(bound >= most);
    CHECK(bound <= 2 * most);
  }
}

TEST_CASE("A long triangle beside many slivers is bounded by how far it is from them") {
  // A strip 1 mm wide, in 500 slivers from its ends, each 5 um beside it.
  constexpr std::uint32_t count = 500;
  test::Shape slivers;
  slivers.vertices = {{0, 0, 5e-6}, {0.05, 1e-3, 5e-6}};
  for (std::uint32_t i = 0; i <= count; ++i) {
    slivers.vertices.emplace_back(0.05 * i / count, i < count / 2 ? -1e-5 : -2e-5, 5e-6);
    if (i > 0) slivers.triangles.push_back({1, i + 1, i + 2});
  }
  slivers.triangles.push_back({0, 2, 1});
  test::Shape whole{{{0, 0, 0}, {0.05, 0, 0}, {0.05, 1e-3, 0}}, {{0, 1, 2}}};
  const double bound = largest_distance(as_surface(whole), Caster(as_surface(slivers)), enough);
  CHECK(bound >= 5e-6);
  CHECK(bound <= 2e-5);
}

}  // namespace spm::baker::surface_distance_test
