// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/surface/self_intersection.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <vector>

#include "baker/mesh/join_vertices.hpp"
#include "common/base/random.hpp"
#include "tests/support/shapes.hpp"

namespace spm::baker::self_intersection_test {

TEST_CASE("A large mesh is cut into slabs, and no pair of its triangles is lost or found twice") {
  // Four balls in a row, each through the next.
  test::Shape all;
  for (int ball = 0; ball < 4; ++ball) {
    const test::Shape one = test::sphere(1, 4);
    const auto first = static_cast<std::uint32_t>(all.vertices.size());
    for (const Vector3& vertex : one.vertices) {
      all.vertices.push_back(vertex + ball * Vector3(0.1, 1.03, 0.2));
    }
    for (const auto& [a, b, c] : one.triangles) {
      all.triangles.push_back({a + first, b + first, c + first});
    }
  }
  const std::vector<TrianglePair> found = meeting_pairs(all.vertices, all.triangles, 0).crossing;
  // Of any two fifths of the triangles, which are too few to be cut.
  const std::size_t fifth = all.triangles.size() / 5;
  std::vector<TrianglePair> expected;
  for (std::size_t i = 0; i < 5; ++i) {
    for (std::size_t k = i + 1; k < 5; ++k) {
      std::vector<Triangle> part;
      std::vector<std::uint32_t> numbers;
      for (const std::size_t from : {i, k}) {
        for (std::size_t t = from * fifth; t < (from + 1) * fifth; ++t) {
          part.push_back(all.triangles[t]);
          numbers.push_back(static_cast<std::uint32_t>(t));
        }
      }
      for (const auto& [a, b] : meeting_pairs(all.vertices, part, 0).crossing) {
        expected.emplace_back(numbers[a], numbers[b]);
      }
    }
  }
  std::sort(expected.begin(), expected.end());
  expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
  CHECK(expected.size() > 500);
  CHECK(found == expected);
}

TEST_CASE("Vertices are joined to the first near enough that stands for itself, and to no other") {
  constexpr double distance = 0.02;
  std::vector<Vector3> vertices;
  for (std::uint64_t n = 0; n < 3000; ++n) {
    vertices.emplace_back(random_unit(1, 3 * n) - 0.5, random_unit(1, 3 * n + 1) - 0.5,
                          0.2 * random_unit(1, 3 * n + 2));
  }
  const std::vector<std::uint32_t> joined = join_vertices(vertices, distance);
  std::size_t others = 0;
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    std::uint32_t expected = 0;
    while (expected < i &&
           (joined[expected] != expected || (vertices[expected] - vertices[i]).norm() > distance)) {
      ++expected;
    }
    REQUIRE(joined[i] == expected);
    others += expected != i ? 1 : 0;
  }
  CHECK(others > 100);
}

TEST_CASE("Faces of two boxes face each other across a gap, and not where they lie on each other") {
  for (const double gap : {0.0, 1e-6}) {
    const test::Shape both =
        test::merged(test::box({1, 1, 1}), test::moved(test::box({1, 1, 1}), {0, 0, 1 + gap}));
    const std::vector<Triangle> triangles(both.triangles.begin(), both.triangles.end());
    const MeetingPairs pairs = meeting_pairs(both.vertices, triangles, 4e-6);
    CHECK(pairs.facing.empty() == (gap == 0));
    CHECK(pairs.crossing.empty() == (gap > 0));
  }
}

}  // namespace spm::baker::self_intersection_test
