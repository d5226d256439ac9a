// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/planes/planes.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <optional>
#include <vector>

#include "baker/base/bake_error.hpp"
#include "common/surface/support_plane_mapping.hpp"
#include "tests/baker/mesh/mesh_support.hpp"
#include "tests/support/random.hpp"

namespace spm::test::planes_test {
namespace {

using baker::convex_hull;
using baker::Hull;
using baker::make_support_planes;
using baker::PlaneKind;

[[nodiscard]] std::vector<std::vector<Vector3>> objects() {
  std::vector<std::vector<Vector3>> all{box({0.1, 0.2, 0.3}).vertices, sphere(0.05, 2).vertices,
                                        torus(0.04, 0.01, 24, 12).vertices,
                                        wedge(0.5, 0.1).vertices, cylinder(0.02, 0.1, 20).vertices};
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    RandomTwister random(seed);
    std::vector<Vector3> cloud;
    for (int i = 0; i < 40; ++i) cloud.push_back(random.in_box({-1, 0, 3}, {1, 0.4, 4}));
    all.push_back(cloud);
  }
  return all;
}

[[nodiscard]] double size_of(const std::vector<Vector3>& points) {
  double size = 0;
  for (const Vector3& point : points) size = std::max(size, point.norm());
  return size;
}

void check_fully_bounding(const std::vector<Vector3>& points,
                          const std::vector<SupportPlane>& planes) {
  const double slack = 1e-12 * size_of(points);
  CHECK(baker::fully_bounding(planes));
  for (const SupportPlane& plane : planes) {
    double nearest = 1e300;
    for (const Vector3& point : points) {
      nearest = std::min(nearest, support_plane_depth(plane, point));
    }
    CHECK(std::abs(nearest) <= slack);  // Definition 1: below the plane, and touching it
    Eigen::Matrix3d basis;
    basis << plane.u, plane.v, plane.n;
    CHECK((basis.transpose() * basis - Eigen::Matrix3d::Identity()).norm() < 1e-14);
    CHECK(basis.determinant() > 0);
  }
  for (const Vector3& point : points) CHECK(in_bounded_space(planes, point, slack));
}

/// Index of the closest plane to a point of the bounded space.
[[nodiscard]] std::size_t closest_plane(const std::vector<SupportPlane>& planes,
                                        const Vector3& point) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < planes.size(); ++i) {
    if (support_plane_depth(planes[i], point) < support_plane_depth(planes[best], point)) best = i;
  }
  return best;
}

}  // namespace

TEST_CASE("Face-based, vertex-based and thinned-out planes fully bound their object") {
  for (const std::vector<Vector3>& points : objects()) {
    const Hull hull = convex_hull(points);
    check_fully_bounding(points, baker::face_based_planes(hull, std::nullopt));
    check_fully_bounding(points, baker::vertex_based_planes(hull, 50));
    for (const std::size_t count : {6U, 10U, 20U}) {
      if (count > hull.facets.size()) continue;
      const auto planes = baker::face_based_planes(hull, count);
      CHECK(planes.size() == count);
      check_fully_bounding(points, planes);
    }
  }
}

TEST_CASE("A face-based plane lies on each face of the hull") {
  for (const std::vector<Vector3>& points : objects()) {
    const Hull hull = convex_hull(points);
    const auto planes = baker::face_based_planes(hull, std::nullopt);
    CHECK(planes.size() == hull.facets.size());
    const double slack = 1e-9 * size_of(points);
    for (const SupportPlane& plane : planes) {
      const auto touching = std::count_if(points.begin(), points.end(), [&](const Vector3& p) {
        return support_plane_depth(plane, p) <= slack;
      });
      CHECK(touching >= 3);
    }
  }
}

TEST_CASE("The mapping gives the plane whose normal is most parallel to the direction") {
  for (const std::vector<Vector3>& points : objects()) {
    const auto planes = baker::vertex_based_planes(convex_hull(points), 100);
    RandomTwister random(3);
    for (int i = 0; i < 200; ++i) {
      const Vector3 direction = 5 * random.direction();
      const Vector3 normal = planes[support_plane_mapping(planes, direction)].n;
      for (const SupportPlane& plane : planes)
        CHECK(plane.n.dot(direction) <= normal.dot(direction));
    }
    for (std::size_t i = 0; i < planes.size(); ++i) {
      CHECK(support_plane_mapping(planes, planes[i].n) == i);
    }
  }
}

TEST_CASE("The mapping takes the lowest index of equal planes") {
  const auto planes = baker::face_based_planes(convex_hull(box({1, 1, 1}).vertices), std::nullopt);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Vector3 between = planes[i].n + planes[j].n;
      if (between.norm() < 0.1) continue;
      CHECK(support_plane_mapping(planes, between) == j);
    }
  }
}

TEST_CASE("A vertex-based plane passes through the support vertex with the normal asked for") {
  RandomTwister random(11);
  const std::vector<Vector3> points = torus(0.04, 0.01, 24, 12).vertices;
  for (int i = 0; i < 100; ++i) {
    const Vector3 normal = random.direction();
    const SupportPlane plane = vertex_support_plane(points, normal);
    CHECK(plane.n == normal);
    CHECK(plane.x0 == points[support_mapping(points, normal)]);
    for (const Vector3& point : points) CHECK(support_plane_depth(plane, point) >= 0);
  }
}

TEST_CASE("A basis is right-handed and orthonormal for the normals where a rule could break") {
  for (const double z : {1.0, -1.0, 0.0, -0.0, 1e-300, -1e-300}) {
    const Vector3 normal = z * z == 1 ? Vector3(0, 0, z) : Vector3(0.6, -0.8, z);
    const SupportPlane plane = plane_with_normal(Vector3::Zero(), normal);
    CHECK((plane.u.cross(plane.v) - normal).norm() < 1e-15);
    CHECK(plane.u.norm() == Approx(1));
    CHECK(plane.v.norm() == Approx(1));
  }
}

TEST_CASE("Planes that leave a side open do not bound") {
  const auto planes = baker::face_based_planes(convex_hull(box({1, 2, 3}).vertices), std::nullopt);
  REQUIRE(planes.size() == 6);
  for (std::size_t gone = 0; gone < 6; ++gone) {
    std::vector<SupportPlane> rest = planes;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(gone));
    CHECK_FALSE(baker::fully_bounding(rest));
  }
  CHECK_FALSE(baker::fully_bounding({}));
}

TEST_CASE("The automatic rule takes facets up to their number and vertex-based planes beyond") {
  const Hull few = convex_hull(box({1, 2, 3}).vertices);
  const Hull many = convex_hull(sphere(1, 3).vertices);
  const auto kind = [](const Hull& hull, std::optional<std::size_t> count) {
    return make_support_planes(hull, PlaneKind::automatic, count).kind;
  };
  CHECK(kind(few, 6) == PlaneKind::face);
  CHECK(kind(few, 7) == PlaneKind::vertex);
  CHECK(kind(few, std::nullopt) == PlaneKind::face);
  CHECK(kind(many, 1280) == PlaneKind::face);
  CHECK(kind(many, 1281) == PlaneKind::vertex);
  CHECK(kind(many, std::nullopt) == PlaneKind::vertex);
  CHECK(make_support_planes(many, PlaneKind::automatic, std::nullopt).planes.size() == 1000);
  CHECK(make_support_planes(many, PlaneKind::automatic, 300).planes.size() == 300);
}

TEST_CASE("Too few planes, or more facets than there are, are a usage error") {
  const Hull hull = convex_hull(box({1, 2, 3}).vertices);
  const auto code = [&](PlaneKind kind, std::size_t count) {
    try {
      (void)make_support_planes(hull, kind, count);
    } catch (const baker::BakeError& error) {
      return error.code();
    }
    return ExitCode::done;
  };
  CHECK(code(PlaneKind::automatic, 3) == ExitCode::usage);
  CHECK(code(PlaneKind::face, 5) == ExitCode::usage);  // a box needs all six
  CHECK(code(PlaneKind::face, 7) == ExitCode::usage);
  CHECK(code(PlaneKind::vertex, 200) == ExitCode::done);
}

TEST_CASE("A plane's own region holds every point that is closest to it") {
  for (const std::vector<Vector3>& points : objects()) {
    const Hull hull = convex_hull(points);
    for (const auto& planes :
         {baker::face_based_planes(hull, std::nullopt), baker::vertex_based_planes(hull, 60)}) {
      std::vector<baker::Rectangle> regions;
      for (std::size_t i = 0; i < planes.size(); ++i) {
        regions.push_back(baker::own_region(planes, i));
      }
      Eigen::AlignedBox3d around;
      for (const Vector3& point : points) around.extend(point);
      RandomTwister random(5);
      for (int i = 0; i < 3000; ++i) {
        const Vector3 point = random.in_box(around.min(), around.max());
        if (!in_bounded_space(planes, point, 0)) continue;
        const std::size_t closest = closest_plane(planes, point);
        const PlaneCoordinates at = project_on_plane(planes[closest], point);
        const baker::Rectangle& region = regions[closest];
        CHECK(at.eta >= region.eta_min);
        CHECK(at.eta <= region.eta_max);
        CHECK(at.omega >= region.omega_min);
        CHECK(at.omega <= region.omega_max);
      }
    }
  }
}

TEST_CASE("The own region of a cube's face is that face and no more") {
  const auto planes = baker::face_based_planes(convex_hull(box({2, 2, 2}).vertices), std::nullopt);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const baker::Rectangle region = baker::own_region(planes, i);
    CHECK(region.eta_min == Approx(-1).epsilon(1e-5));
    CHECK(region.eta_max == Approx(1).epsilon(1e-5));
    CHECK(region.omega_min == Approx(-1).epsilon(1e-5));
    CHECK(region.omega_max == Approx(1).epsilon(1e-5));
  }
}

TEST_CASE("The own region of a plane that is never closest is empty or a point") {
  // A plane through a corner of the box lies above the faces' planes everywhere but there.
  const std::vector<Vector3> points = box({2, 2, 2}).vertices;
  auto planes = baker::face_based_planes(convex_hull(points), std::nullopt);
  planes.push_back(vertex_support_plane(points, Vector3(1, 1, 1).normalized()));
  const baker::Rectangle region = baker::own_region(planes, 6);
  CHECK(region.eta_max - region.eta_min < 1e-4);
  CHECK(region.omega_max - region.omega_min < 1e-4);
}

TEST_CASE("Fibonacci directions are spread evenly") {
  for (const std::size_t count : {1U, 10U, 1000U}) {
    const std::vector<Vector3> directions = baker::fibonacci_directions(count);
    REQUIRE(directions.size() == count);
    Vector3 sum = Vector3::Zero();
    for (const Vector3& d : directions) {
      CHECK(d.norm() == Approx(1));
      sum += d;
    }
    CHECK(sum.norm() <= 2);
  }
  const std::vector<Vector3> directions = baker::fibonacci_directions(500);
  const double typical = std::sqrt(4 * 3.14159 / 500);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    double nearest = 10;
    for (std::size_t j = 0; j < directions.size(); ++j) {
      if (i != j) nearest = std::min(nearest, (directions[i] - directions[j]).norm());
    }
    CHECK(nearest > 0.5 * typical);
    CHECK(nearest < 1.5 * typical);
  }
}

}  // namespace spm::test::planes_test
