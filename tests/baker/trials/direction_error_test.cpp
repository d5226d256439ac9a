// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/trials/direction_error.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "tests/baker/pipeline/bake_support.hpp"

namespace spm::baker::direction_error_test {
namespace {

BakeResult baked(const test::Shape& shape) {
  BakeOptions options;
  options.tolerance = 1e-4;
  options.max_depth = 0.001;
  return bake(test::mesh_of(shape), options);
}

/// The shape turned about the x axis.
test::Shape turned(test::Shape shape, double angle) {
  for (Vector3& vertex : shape.vertices) {
    const double y = vertex.y(), z = vertex.z();
    vertex.y() = std::cos(angle) * y - std::sin(angle) * z;
    vertex.z() = std::sin(angle) * y + std::cos(angle) * z;
  }
  return shape;
}

TEST_CASE("Directions of a box are exact, and off by its turn against one that is turned") {
  const test::Shape box = test::box({0.02, 0.02, 0.02});
  const BakeResult result = baked(box);
  CHECK(median_direction_error(result.asset, Caster(test::surface_of(box)), 1) < 1e-4);
  // Four of the six faces turn.
  const Caster other(test::surface_of(turned(box, 0.02)));
  CHECK(median_direction_error(result.asset, other, 1) == Approx(0.02).margin(1e-3));
}

TEST_CASE("Facets smaller than tiles get directions within a degree in the median") {
  test::Shape rough = test::sphere(0.01, 5);
  for (std::size_t i = 0; i < rough.vertices.size(); ++i) {
    rough.vertices[i] *= 1 + 1e-3 * std::sin(1e4 * static_cast<double>(i));
  }
  const BakeResult result = baked(rough);
  CHECK(result.report.direction < 1.0 * std::numbers::pi / 180);
  CHECK(median_direction_error(result.asset, Caster(test::surface_of(rough)), 9) <
        1.1 * std::numbers::pi / 180);
}

}  // namespace
}  // namespace spm::baker::direction_error_test
