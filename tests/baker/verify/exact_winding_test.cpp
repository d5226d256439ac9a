// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/exact_winding.hpp"

#include <catch2/catch.hpp>

#include "common/base/random.hpp"
#include "tests/baker/mesh/triangle_winding.hpp"
#include "tests/baker/verify/verify_shapes.hpp"

namespace exact_winding_test {

using namespace spm;
using namespace spm::baker;

TEST_CASE("By exact crossings a point beside closed parts has the same winding number") {
  for (const Mesh& mesh :
       {test::as_mesh(test::sphere(0.05, 4)), test::as_mesh(test::torus(0.03, 0.01, 60, 30)),
        test::as_mesh(test::merged(test::sphere(0.03, 3), test::box({0.05, 0.02, 0.08})))}) {
    const ExactWinding winding(mesh);
    for (std::uint64_t i = 0; i < 300; ++i) {
      const Vector3 point = test::point_around(
          mesh, 0.01, random_unit(6, 3 * i), random_unit(6, 3 * i + 1), random_unit(6, 3 * i + 2));
      CHECK(winding.at(point) == Approx(test::summed_winding(mesh, point)).margin(1e-10));
    }
  }
}

TEST_CASE("By exact crossings places above and below faces, sides and corners of a box are told") {
  const Mesh mesh = test::as_mesh(test::box({2, 2, 2}));
  const ExactWinding winding(mesh);
  for (const Vector3& way : {Vector3(1, 0, 0), Vector3(0, 1, 1), Vector3(-1, 1, 1)}) {
    CHECK(winding.at((1 - 1e-12) * way) == 1);
    CHECK(winding.at((1 + 1e-12) * way) == 0);
  }
  CHECK(winding.at({0.3, 0.2, 1}) == 1);
}

}  // namespace exact_winding_test
