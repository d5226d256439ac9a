// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/winding_number.hpp"

#include <catch2/catch.hpp>

#include "common/base/random.hpp"
#include "tests/baker/mesh/triangle_winding.hpp"
#include "tests/baker/verify/verify_shapes.hpp"

namespace winding_number_test {

using namespace spm;
using namespace spm::baker;

namespace {

Mesh without_every_seventh(test::Shape shape) {
  std::vector<std::array<std::uint32_t, 3>> kept;
  for (std::size_t i = 0; i < shape.triangles.size(); ++i) {
    if (i % 7 != 0) kept.push_back(shape.triangles[i]);
  }
  shape.triangles = kept;
  Mesh mesh = test::as_mesh(shape);
  mesh.sheet_triangles = 0;
  return mesh;
}

}  // namespace

TEST_CASE("The winding number by boundary fans is the sum over all triangles, holes or not") {
  const std::vector<Mesh> meshes{
      test::as_mesh(test::sphere(0.05, 4)), test::as_mesh(test::torus(0.03, 0.01, 60, 30)),
      without_every_seventh(test::sphere(0.05, 3)),
      without_every_seventh(test::torus(0.03, 0.01, 40, 20)),
      test::as_mesh(test::merged(test::sphere(0.03, 3), test::box({0.05, 0.02, 0.08})))};
  for (const Mesh& mesh : meshes) {
    const WindingNumber winding(mesh.vertices, mesh.triangles);
    for (std::uint64_t i = 0; i < 300; ++i) {
      const Vector3 point = test::point_around(
          mesh, 0.01, random_unit(5, 3 * i), random_unit(5, 3 * i + 1), random_unit(5, 3 * i + 2));
      CHECK(winding.at(point) == Approx(test::summed_winding(mesh, point)).margin(1e-10));
    }
  }
}

TEST_CASE("The winding number counts the parts that a point is in") {
  const Mesh mesh = test::as_mesh(
      test::merged(test::sphere(0.03, 3), test::moved(test::sphere(0.03, 3), {0.03, 0, 0})));
  const WindingNumber winding(mesh.vertices, mesh.triangles);
  CHECK(winding.at({0.015, 0, 0}) == Approx(2));
  CHECK(winding.at({-0.02, 0, 0}) == Approx(1));
  CHECK(winding.at({0.05, 0, 0}) == Approx(1));
  CHECK(winding.at({0, 0.05, 0}) == Approx(0).margin(1e-12));
}

}  // namespace winding_number_test
