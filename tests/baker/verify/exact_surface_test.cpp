// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/exact_surface.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "common/base/random.hpp"
#include "tests/baker/verify/verify_shapes.hpp"

namespace exact_surface_test {

using namespace spm;
using namespace spm::baker;

namespace {

double signed_distance(const ExactSurface& surface, const Vector3& point) {
  return surface.distance(point, surface.closest(point));
}

Vector3 random_point(const Mesh& mesh, std::uint64_t seed, std::uint64_t index) {
  return test::point_around(mesh, 0.01, random_unit(seed, 3 * index),
                            random_unit(seed, 3 * index + 1), random_unit(seed, 3 * index + 2));
}

double box_distance(const Vector3& half, const Vector3& point) {
  const Vector3 q = point.cwiseAbs() - half;
  return q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0);
}

/// Distance inside the union of two spheres of one radius on the x axis to the part of the first
/// that is not in the second; `middle` is the plane between them, `sign` the first one's side.
double depth_to_sphere(const Vector3& point, const Vector3& centre, double radius, double middle,
                       double sign) {
  const Vector3 radial = point - centre;
  const double distance = radial.norm();
  const Vector3 closest_point = centre + radial * (radius / distance);
  if (sign * (closest_point.x() - middle) >= 0) return std::abs(radius - distance);
  const double ring = std::sqrt(radius * radius - (middle - centre.x()) * (middle - centre.x()));
  const double off_axis = std::hypot(point.y(), point.z());
  return std::hypot(point.x() - middle, off_axis - ring);
}

}  // namespace

TEST_CASE("The distance to a box is the closed form's") {
  const Vector3 size(0.06, 0.04, 0.08);
  const Mesh mesh = test::as_mesh(test::box(size));
  const ExactSurface surface(mesh);
  for (std::uint64_t i = 0; i < 5000; ++i) {
    const Vector3 point = random_point(mesh, 11, i);
    CHECK(signed_distance(surface, point) == Approx(box_distance(size / 2, point)).margin(1e-12));
  }
}

TEST_CASE("The distance to a fine sphere is the closed form's up to its facets") {
  const Mesh mesh = test::as_mesh(test::sphere(0.05, 5));
  const ExactSurface surface(mesh);
  for (std::uint64_t i = 0; i < 3000; ++i) {
    const Vector3 point = random_point(mesh, 12, i);
    CHECK(signed_distance(surface, point) == Approx(point.norm() - 0.05).margin(15e-6));
  }
}

TEST_CASE("The distance to a fine torus is the closed form's up to its facets") {
  const Mesh mesh = test::as_mesh(test::torus(0.03, 0.012, 256, 128));
  const ExactSurface surface(mesh);
  for (std::uint64_t i = 0; i < 3000; ++i) {
    const Vector3 point = random_point(mesh, 13, i);
    const double exact = std::hypot(std::hypot(point.x(), point.y()) - 0.03, point.z()) - 0.012;
    CHECK(signed_distance(surface, point) == Approx(exact).margin(10e-6));
  }
}

TEST_CASE("What of two overlapping spheres lies in the other is no surface") {
  const double radius = 0.03;
  const double offset = 0.02;
  const test::Shape sphere = test::sphere(radius, 5);
  const Mesh mesh =
      test::as_mesh(test::merged(sphere, test::moved(sphere, {2 * offset, 0.0, 0.0})));
  const ExactSurface surface(mesh);
  // Two caps of height radius - offset are hidden.
  const double cap = 2 * std::numbers::pi * radius * (radius - offset);
  CHECK(surface.hidden_area() == Approx(2 * cap).epsilon(0.002));
  CHECK(surface.area() == Approx(8 * std::numbers::pi * radius * radius - 2 * cap).epsilon(0.002));
  const Vector3 second(2 * offset, 0, 0);
  for (std::uint64_t i = 0; i < 3000; ++i) {
    const Vector3 point = random_point(mesh, 14, i);
    const double outside = std::min(point.norm(), (point - second).norm()) - radius;
    const double inside = -std::min(depth_to_sphere(point, Vector3::Zero(), radius, offset, -1),
                                    depth_to_sphere(point, second, radius, offset, 1));
    CHECK(signed_distance(surface, point) == Approx(outside > 0 ? outside : inside).margin(15e-6));
  }
}

TEST_CASE("Boxes that overlap with faces in one plane make one solid") {
  // Cut along edges that lie in the other's faces: the hardest case for cutting by planes.
  const Mesh mesh = test::as_mesh(test::merged(
      test::box({0.04, 0.02, 0.02}), test::moved(test::box({0.04, 0.02, 0.02}), {0.02, 0.0, 0.0})));
  const ExactSurface surface(mesh);
  const Vector3 centre(0.01, 0, 0);
  for (std::uint64_t i = 0; i < 3000; ++i) {
    const Vector3 point = random_point(mesh, 15, i);
    const double exact = box_distance({0.03, 0.01, 0.01}, point - centre);
    CHECK(signed_distance(surface, point) == Approx(exact).margin(1e-9));
  }
}

TEST_CASE("The face that two touching boxes share is no surface") {
  const Mesh mesh = test::as_mesh(test::merged(
      test::box({0.02, 0.02, 0.02}), test::moved(test::box({0.02, 0.02, 0.02}), {0.02, 0.0, 0.0})));
  const ExactSurface surface(mesh);
  CHECK(surface.hidden_area() == Approx(2 * 0.02 * 0.02));
  CHECK(signed_distance(surface, {0.0101, 0, 0.001}) == Approx(-0.009));
}

TEST_CASE("A gap is a gap and a wall is a wall, however thin they are") {
  const Vector3 size(0.02, 0.02, 0.02);
  // A wedge of air below a box, no higher than a third of a millionth of the diagonal.
  test::Shape upper = test::moved(test::box(size), {0, 0, 0.02});
  for (Vector3& vertex : upper.vertices) {
    if (vertex.x() > 0 && vertex.z() < 0.02) vertex.z() += 1e-8;
  }
  CHECK(ExactSurface(test::as_mesh(test::merged(test::box(size), upper))).hidden_area() ==
        Approx(0).margin(1e-9));
  test::Shape wall = test::moved(test::box({0.02, 0.02, 1e-11}), {0, 0, 0.02});
  CHECK(ExactSurface(test::as_mesh(test::merged(test::box(size), wall))).hidden_area() ==
        Approx(0).margin(1e-9));
}

TEST_CASE("Boxes that cross at any angle keep the closed form of their union outside") {
  const Vector3 half(0.03, 0.01, 0.015);
  const test::Shape upright = test::box(2 * half);
  test::Shape turned = upright;
  const Eigen::AngleAxisd turn(0.7, Vector3(1, 2, 3).normalized());
  for (Vector3& vertex : turned.vertices) vertex = turn * vertex;
  const Mesh mesh = test::as_mesh(test::merged(upright, turned));
  const ExactSurface surface(mesh);
  CHECK(surface.hidden_area() > 0);
  for (std::uint64_t i = 0; i < 3000; ++i) {
    const Vector3 point = random_point(mesh, 16, i);
    const double exact =
        std::min(box_distance(half, point), box_distance(half, turn.inverse() * point));
    const double found = signed_distance(surface, point);
    if (exact > 0) {
      CHECK(found == Approx(exact).margin(1e-9));
    } else {
      CHECK(found <= exact + 1e-9);  // deeper than in either box alone
    }
  }
}

TEST_CASE("A cavity is outside, and its wall is surface") {
  const Mesh mesh = test::as_mesh(
      test::merged(test::sphere(0.05, 4), test::turned_inside_out(test::sphere(0.02, 4))));
  const ExactSurface surface(mesh);
  CHECK(surface.hidden_area() == 0);
  CHECK(signed_distance(surface, {0, 0, 0.001}) == Approx(0.019).margin(60e-6));
  CHECK(signed_distance(surface, {0, 0, 0.023}) == Approx(-0.003).margin(60e-6));
}

TEST_CASE("An open box is a sheet, felt from both sides") {
  test::Shape shape = test::box({0.02, 0.02, 0.02});
  // The two triangles of the face at +x are removed.
  shape.triangles.resize(10);
  const ExactSurface surface(test::as_mesh(shape), 0.0005);
  for (const double x : {-0.008, -0.012}) {
    CHECK(signed_distance(surface, {x, 0, 0}) == Approx(0.0015));
  }
  CHECK(signed_distance(surface, {0.01, 0, 0}) == Approx(0.0095));
  CHECK(signed_distance(surface, {-0.0101, 0, 0}) == Approx(-0.0004));
}

TEST_CASE("What of a sheet lies in a solid is not felt") {
  const test::Shape solid = test::box({0.02, 0.02, 0.02});
  test::Shape sheet;
  sheet.vertices = {{-0.03, -0.03, 0}, {0.03, -0.03, 0}, {0.03, 0.03, 0}, {-0.03, 0.03, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  Mesh mesh = test::as_mesh(test::merged(solid, sheet));
  mesh.sheet_triangles = 2;
  const ExactSurface surface(mesh, 0.0005);
  CHECK(surface.hidden_area() == Approx(4e-4));
  CHECK(signed_distance(surface, {0, 0, 0.001}) == Approx(-0.009));
  CHECK(signed_distance(surface, {0.02, 0, 0.001}) == Approx(0.0005));
  CHECK(signed_distance(surface, {0.02, 0, -0.0002}) == Approx(-0.0003));
}

TEST_CASE("Within a closed gap all is inside, and what bounds it is no surface") {
  const test::Shape below = test::box({0.06, 0.06, 0.06});
  for (const double gap : {0.0, 1e-7, 1e-6}) {
    const ExactSurface surface(
        test::as_mesh(test::merged(
            below, test::moved(test::box({0.024, 0.024, 0.02}), {0.001, 0.002, 0.04 + gap}))),
        0, 1e-4);
    INFO(gap);
    CHECK(signed_distance(surface, {0.001, 0.002, 0.03 + gap / 2}) == Approx(-0.012).margin(2e-6));
    CHECK(signed_distance(surface, {0.001, 0.002, 0.029}) == Approx(-0.012).epsilon(0.01));
    CHECK(signed_distance(surface, {0.025, 0, 0.031}) == Approx(0.001));
    CHECK(surface.area() == Approx(6 * 0.0036 + 4 * 0.024 * 0.02).epsilon(1e-4));
  }
}

TEST_CASE("Of a closed gap its ends are no surface") {
  const double gap = 5e-7;
  const test::Shape slit = test::turned_inside_out(test::box({0.04, 0.04, gap}));
  const baker::Mesh mesh = test::as_mesh(test::merged(test::box({0.1, 0.1, 0.1}), slit));
  const ExactSurface closed(mesh, 0, 1e-4), open(mesh, 0, 1e-5);
  CHECK(signed_distance(closed, {0.021, 0, 0}) == Approx(-0.029));
  CHECK(signed_distance(open, {0.021, 0, 0}) == Approx(-0.001));
}

TEST_CASE("Directions are contested near the medial axis and nowhere else") {
  const ExactSurface surface(test::as_mesh(test::box({0.1, 0.1, 0.1})));
  const auto contested = [&](const Vector3& point) {
    return surface.contested(point, surface.closest(point), 1e-4);
  };
  CHECK_FALSE(contested({0.049, 0.01, 0.02}));
  CHECK_FALSE(contested({0.049, 0.0478, 0.02}));
  CHECK(contested({0.049, 0.04895, 0.02}));
  CHECK_FALSE(contested({0.0505, 0.0502, 0.02}));  // outside, beside an edge: one closest point
  CHECK(contested({0.049, 0.049, 0.049}));
}

TEST_CASE("Points drawn from the surface lie on it, evenly") {
  const Mesh mesh = test::as_mesh(test::box({0.1, 0.05, 0.05}));
  const ExactSurface surface(mesh);
  const int draws = 20000;
  int on_ends = 0;
  for (std::uint64_t i = 0; i < draws; ++i) {
    const SurfacePoint point =
        surface.at(random_unit(17, 3 * i), random_unit(17, 3 * i + 1), random_unit(17, 3 * i + 2));
    CHECK(std::abs(box_distance({0.05, 0.025, 0.025}, point.position)) < 1e-12);
    if (std::abs(point.normal.x()) > 0.5) ++on_ends;
  }
  const double expected = 2 * 0.05 * 0.05 / (2 * 0.05 * 0.05 + 4 * 0.1 * 0.05);
  CHECK(on_ends / static_cast<double>(draws) == Approx(expected).margin(0.01));
}

TEST_CASE("A surface turned inside out bounds no solid") {
  const ExactSurface surface(test::as_mesh(test::turned_inside_out(test::merged(
      test::box({0.1, 0.1, 0.1}), test::moved(test::box({0.1, 0.1, 0.1}), {1.0, 0.0, 0.0})))));
  CHECK(surface.empty());
}

}  // namespace exact_surface_test
