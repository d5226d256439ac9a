// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/surface/solid_side.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <vector>

#include "common/base/random.hpp"
#include "tests/baker/mesh/triangle_winding.hpp"
#include "tests/baker/verify/verify_shapes.hpp"

namespace spm::baker::solid_side_test {
namespace {

SolidSide side_of(const test::Shape& shape) { return {shape.vertices, shape.triangles}; }

Vector3 anywhere(std::uint64_t seed, std::uint64_t number) {
  const auto unit = [&](std::uint64_t k) { return 2 * random_unit(seed, 3 * number + k) - 1; };
  return {unit(0), unit(1), unit(2)};
}

TEST_CASE("Crossings of a line tell the winding number, also where parts overlap") {
  const test::Shape shape = test::merged(test::torus(0.035, 0.012, 40, 20),
                                         test::moved(test::box({0.06, 0.02, 0.02}), {0.02, 0, 0}));
  const SolidSide side = side_of(shape);
  const Mesh mesh = test::as_mesh(shape);
  int twice = 0;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const Vector3 point = 0.06 * anywhere(24, i);
    CHECK(side.winding(point) == std::lround(test::summed_winding(mesh, point)));
    twice += side.winding(point) == 2 ? 1 : 0;
  }
  CHECK(twice > 0);
}

TEST_CASE("A line that passes an edge within rounding tells nothing wrong of the side") {
  const Vector3 half(0.01, 0.02, 0.03);
  const SolidSide side = side_of(test::box(2 * half));
  // The line that is asked along; places before an edge lie on it, to within nanometres.
  const Vector3 direction = Vector3(1, -0.0417, 0.0331).normalized();
  std::size_t wrong = 0;
  for (std::uint64_t i = 0; i < 20'000; ++i) {
    Vector3 on = half.cwiseProduct(anywhere(23, 3 * i));
    const auto free = static_cast<int>(i % 3);
    for (const int axis : {(free + 1) % 3, (free + 2) % 3})
      on[axis] = std::copysign(half[axis], on[axis]);
    const Vector3 nudge = 2e-9 * anywhere(23, 3 * i + 1);
    const double away = 0.01 * (0.1 + std::abs(random_unit(23, i)));
    const Vector3 place = on - away * direction + nudge;
    const bool inside = (place.cwiseAbs() - half).maxCoeff() < 0;
    wrong += (side.winding(place) > 0) == inside ? 0 : 1;
  }
  CHECK(wrong == 0);
}

TEST_CASE("A line that leaves by a gap is not believed") {
  // A box without a strip of its top, 20 um wide, under which places lie.
  test::Shape shape = test::box({0.02, 0.02, 0.01});
  std::erase_if(shape.triangles, [&](const auto& triangle) {
    return std::all_of(triangle.begin(), triangle.end(),
                       [&](std::uint32_t corner) { return shape.vertices[corner].z() > 0; });
  });
  const auto first = static_cast<std::uint32_t>(shape.vertices.size());
  for (const double x : {-0.01, -1e-5, 1e-5, 0.01}) {
    for (const double y : {-0.01, 0.01}) shape.vertices.emplace_back(x, y, 0.005);
  }
  for (const std::uint32_t k : {first, first + 4}) {
    shape.triangles.push_back({k, k + 2, k + 3});
    shape.triangles.push_back({k, k + 3, k + 1});
  }
  const SolidSide side = side_of(shape);
  for (std::uint64_t i = 0; i < 200; ++i) {
    const double below = 1e-3 * (0.2 + random_unit(25, 2 * i));
    const double y = 0.008 * (2 * random_unit(25, 2 * i + 1) - 1);
    // The line is slanted by some per cent; some of these leave by the gap.
    CHECK(side.winding({below * -0.0523, y, 0.005 - below}) == 1);
    CHECK(side.winding({below * 0.0523, y, 0.005 + below}) == 0);
  }
}

}  // namespace
}  // namespace spm::baker::solid_side_test
