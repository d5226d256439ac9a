// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/planes/hull.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "baker/base/bake_error.hpp"
#include "tests/baker/mesh/mesh_support.hpp"
#include "tests/support/random.hpp"

namespace spm::test::hull_test {
namespace {

using baker::convex_hull;
using baker::Hull;

[[nodiscard]] double reach(const std::vector<Vector3>& points, const Vector3& direction) {
  double farthest = -1e300;
  for (const Vector3& point : points) farthest = std::max(farthest, direction.dot(point));
  return farthest;
}

[[nodiscard]] std::vector<Vector3> random_cloud(std::uint64_t seed, double size) {
  RandomTwister random(seed);
  std::vector<Vector3> points;
  const Vector3 offset = size * random.in_box({-1, -1, -1}, {1, 1, 1});
  const auto count = static_cast<int>(4 + random.unit() * 200);
  for (int i = 0; i < count; ++i) {
    points.push_back(offset + size * random.in_box({-1, -1, -1}, {1, 1, 1}));
  }
  return points;
}

void check_support_planes(const std::vector<Vector3>& points, const Hull& hull) {
  double size = 0;
  for (const Vector3& point : points) size = std::max(size, point.norm());
  for (const auto& facet : hull.facets) {
    CHECK(facet.normal.norm() == Approx(1).epsilon(1e-14));
    CHECK(facet.area > 0);
    CHECK(std::abs(reach(points, facet.normal) - facet.normal.dot(facet.point)) < 1e-12 * size);
  }
}

}  // namespace

TEST_CASE("A box has six merged facets with their areas and centres") {
  const Hull hull = convex_hull(box({1, 2, 3}).vertices);
  REQUIRE(hull.facets.size() == 6);
  CHECK(hull.vertices.size() == 8);
  std::vector<double> areas;
  for (const auto& facet : hull.facets) {
    areas.push_back(facet.area);
    CHECK(facet.normal.lpNorm<1>() == Approx(1));
    CHECK((facet.point - facet.point.dot(facet.normal) * facet.normal).norm() < 1e-12);
  }
  std::sort(areas.begin(), areas.end());
  const std::vector<double> expected{2, 2, 3, 3, 6, 6};
  for (std::size_t i = 0; i < 6; ++i) CHECK(areas[i] == Approx(expected[i]));
}

TEST_CASE("A box with a grid of points on its faces has six facets all the same") {
  std::vector<Vector3> points;
  for (int i = 0; i <= 10; ++i) {
    for (int j = 0; j <= 10; ++j) {
      for (const double side : {-1.0, 1.0}) {
        const double a = 0.2 * i - 1;
        const double b = 0.2 * j - 1;
        points.insert(points.end(), {{a, b, side}, {a, side, b}, {side, a, b}});
      }
    }
  }
  SECTION("exactly") { CHECK(convex_hull(points).facets.size() == 6); }
  SECTION("within rounding of floats and a turn") {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()).toRotationMatrix();
    for (Vector3& point : points) point = (turn * point).cast<float>().cast<double>();
    CHECK(convex_hull(points).facets.size() == 6);
  }
}

TEST_CASE("Every triangle of a sphere mesh is a facet") {
  const Shape shape = sphere(0.05, 3);
  const Hull hull = convex_hull(shape.vertices);
  CHECK(hull.facets.size() == shape.triangles.size());
  CHECK(hull.vertices.size() == shape.vertices.size());
  double sum = 0;
  for (const auto& facet : hull.facets) sum += facet.area;
  CHECK(sum == Approx(area(shape.vertices, shape.triangles)));
}

TEST_CASE("A cylinder has its sides and two ends as facets") {
  CHECK(convex_hull(cylinder(1, 2, 48).vertices).facets.size() == 50);
}

TEST_CASE("Each facet's plane has all points below it and touches one") {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    for (const double size : {1e-6, 0.1, 1e6}) {
      const std::vector<Vector3> points = random_cloud(seed, size);
      check_support_planes(points, convex_hull(points));
    }
  }
  for (const Shape& shape : {torus(0.04, 0.01, 60, 30), wedge(0.3, 0.1), plate({0.1, 0.1, 1e-5})}) {
    check_support_planes(shape.vertices, convex_hull(shape.vertices));
  }
}

TEST_CASE("The hull's facets do not depend on the order of the points") {
  std::vector<Vector3> points = random_cloud(7, 1);
  const Hull first = convex_hull(points);
  std::reverse(points.begin(), points.end());
  const Hull second = convex_hull(points);
  REQUIRE(first.facets.size() == second.facets.size());
  for (std::size_t i = 0; i < first.facets.size(); ++i) {
    CHECK((first.facets[i].normal - second.facets[i].normal).norm() < 1e-12);
  }
  CHECK(first.vertices == second.vertices);
}

TEST_CASE("Points in one plane, on a line or too few have no hull") {
  Shape sheet = sphere(1, 2);
  for (Vector3& vertex : sheet.vertices) vertex.z() = 0.3 * vertex.x() - 2 * vertex.y();
  const std::vector<std::vector<Vector3>> flat{
      sheet.vertices, {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}, {{0, 0, 0}}, {}};
  for (const auto& points : flat) {
    CHECK_THROWS_AS((void)convex_hull(points), baker::BakeError);
  }
}

}  // namespace spm::test::hull_test
