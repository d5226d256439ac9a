// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/sliver_removal.hpp"

#include <catch2/catch.hpp>
#include <cstddef>
#include <map>

#include "common/base/random.hpp"
#include "tests/baker/field/loose_triangles.hpp"
#include "tests/support/shapes.hpp"

namespace spm::baker::sliver_removal_test {

using test::is_closed;
using test::loose;
namespace {

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

/// A box with corners along one of its sides, nearly in line, that one of the two faces has and the
/// other has not; slivers fill what is between.
test::Shape fringed_box(std::uint64_t seed, double off) {
  test::Shape box = test::box({0.01, 0.01, 0.01});
  const auto [a, b, c] = box.triangles[0];
  box.triangles.erase(box.triangles.begin());
  std::vector<std::uint32_t> line{a};
  const Vector3 from = box.vertices[a], to = box.vertices[b];
  for (std::uint64_t n = 0; n < 8; ++n) {
    line.push_back(static_cast<std::uint32_t>(box.vertices.size()));
    const double share = (static_cast<double>(n) + 0.2 + 0.6 * random_unit(seed, 3 * n)) / 8;
    box.vertices.emplace_back(
        from + share * (to - from) +
        off * direction_of(random_unit(seed, 3 * n + 1), random_unit(seed, 3 * n + 2)));
  }
  line.push_back(b);
  for (std::size_t n = 0; n + 1 < line.size(); ++n) {
    box.triangles.push_back({line[n], line[n + 1], c});
  }
  // Ears are cut off in any order.
  for (std::uint64_t n = 100; line.size() > 2; ++n) {
    const auto ear =
        1 + static_cast<std::size_t>(random_unit(seed, n) * static_cast<double>(line.size() - 2));
    box.triangles.push_back({line[ear - 1], line[ear + 1], line[ear]});
    line.erase(line.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  return box;
}

}  // namespace

TEST_CASE("Slivers among slivers go, in whatever order corners in line were joined") {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const test::Shape box = fringed_box(seed, 2e-7);
    std::vector<LooseTriangle> triangles = loose(box);
    REQUIRE(is_closed(triangles));
    INFO("seed " << seed);
    CHECK(remove_slivers(box.vertices, 1e-6, triangles) < 4e-6);
    CHECK(is_closed(triangles));
    CHECK(least_height(box.vertices, triangles) >= 1e-6);
    CHECK(triangles.size() == 12 + 2 * 8);
  }
}

TEST_CASE("Slivers that lie on each other go, but one that nothing else joins stays") {
  test::Shape box = test::box({0.01, 0.01, 0.01});
  const auto [a, b, c] = box.triangles[0];
  const auto middle = static_cast<std::uint32_t>(box.vertices.size());
  box.vertices.emplace_back((box.vertices[a] + box.vertices[b]) / 2);
  box.triangles.push_back({a, b, middle});
  box.triangles.push_back({b, a, middle});
  std::vector<LooseTriangle> triangles = loose(box);
  CHECK(remove_slivers(box.vertices, 1e-6, triangles) < 1e-6);
  CHECK(is_closed(triangles));
  CHECK(triangles.size() == 14);

  std::vector<LooseTriangle> alone{{{a, b, middle}, false}, {{b, a, middle}, false}};
  (void)remove_slivers(box.vertices, 1e-6, alone);
  CHECK(alone.size() == 2);
}

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

TEST_CASE("Of a loose sheet that is smaller than a sliver something is left") {
  const std::vector<Vector3> vertices{{0, 0, 0},    {1, 0, 0},    {1, 1, 0},   {2, 0, 0},
                                      {2, 1e-4, 0}, {2, 0, 1e-4}, {1, 1e-4, 0}};
  std::vector<LooseTriangle> triangles{{.corners = {0, 1, 2}, .sheet = true},
                                       {.corners = {3, 4, 5}, .sheet = true},
                                       {.corners = {1, 2, 6}, .sheet = true}};
  (void)remove_slivers(vertices, 1e-3, triangles);
  // The third lies on the first, and goes.
  REQUIRE(triangles.size() == 2);
  CHECK(triangles[1].corners == Triangle{3, 4, 5});
}

}  // namespace spm::baker::sliver_removal_test
