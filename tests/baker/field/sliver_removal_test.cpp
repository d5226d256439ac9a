// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/sliver_removal.hpp"

#include <catch2/catch.hpp>
#include <map>

#include "common/base/random.hpp"
#include "tests/support/shapes.hpp"

namespace spm::baker::sliver_removal_test {
namespace {

std::vector<LooseTriangle> loose(const test::Shape& shape) {
  std::vector<LooseTriangle> triangles;
  for (const auto& corners : shape.triangles) triangles.push_back({corners, false, false});
  return triangles;
}

bool is_closed(const std::vector<LooseTriangle>& triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> ways;
  for (const LooseTriangle& triangle : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangle.corners[k], b = triangle.corners[(k + 1) % 3];
      ways[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  }
  return std::all_of(ways.begin(), ways.end(), [](const auto& way) { return way.second == 0; });
}

double least_height(const std::vector<Vector3>& vertices,
                    const std::vector<LooseTriangle>& triangles) {
  double least = 1;
  for (const LooseTriangle& triangle : triangles) {
    const Vector3 &a = vertices[triangle.corners[0]], &b = vertices[triangle.corners[1]],
                  &c = vertices[triangle.corners[2]];
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    least = std::min(least, (b - a).cross(c - a).norm() / longest);
  }
  return least;
}

}  // namespace

TEST_CASE("A shape without slivers stays as it is") {
  const test::Shape sphere = test::sphere(0.01, 2);
  std::vector<LooseTriangle> triangles = loose(sphere);
  CHECK(remove_slivers(sphere.vertices, 1e-6, triangles) == 0);
  CHECK(triangles.size() == sphere.triangles.size());
}

TEST_CASE("A corner next to the opposite side goes to the neighbour, and what is closed stays so") {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    test::Shape shape = test::sphere(0.01, 2);
    // Some triangles get a corner in the middle of a side, a little off it.
    for (std::size_t n = 0; n < 10; ++n) {
      const auto t = static_cast<std::size_t>(random_unit(seed, n) *
                                              static_cast<double>(shape.triangles.size()));
      const auto [a, b, c] = shape.triangles[t];
      const auto middle = static_cast<std::uint32_t>(shape.vertices.size());
      const Vector3 inwards = shape.vertices[c] - (shape.vertices[a] + shape.vertices[b]) / 2;
      shape.vertices.push_back((shape.vertices[a] + shape.vertices[b]) / 2 + 1e-5 * inwards);
      shape.triangles[t] = {a, b, middle};
      shape.triangles.push_back({b, c, middle});
      shape.triangles.push_back({c, a, middle});
    }
    std::vector<LooseTriangle> triangles = loose(shape);
    REQUIRE(is_closed(triangles));
    const double displaced = remove_slivers(shape.vertices, 1e-6, triangles);
    CHECK(is_closed(triangles));
    CHECK(displaced <= 1e-5);
    CHECK(least_height(shape.vertices, triangles) >= 1e-6);
  }
}

TEST_CASE("Corners that are nearly one become one, and the triangles between them go") {
  test::Shape box = test::box({0.01, 0.01, 0.01});
  // A needle: one corner becomes two.
  const auto copy = static_cast<std::uint32_t>(box.vertices.size());
  const auto [a, b, c] = box.triangles[0];
  box.vertices.push_back(box.vertices[a] + 1e-8 * (box.vertices[b] - box.vertices[a]).normalized());
  box.triangles[0] = {copy, b, c};
  box.triangles.push_back({a, copy, c});
  std::vector<LooseTriangle> triangles = loose(box);
  CHECK(remove_slivers(box.vertices, 1e-6, triangles) <= 1.1e-8);
  CHECK(triangles.size() == 12);
  CHECK(is_closed(triangles));
}

}  // namespace spm::baker::sliver_removal_test
