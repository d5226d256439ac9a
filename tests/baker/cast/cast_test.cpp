// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/cast/cast.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "common/base/random.hpp"
#include "common/surface/support_plane_mapping.hpp"
#include "tests/baker/pipeline/bake_support.hpp"

namespace spm::baker::cast_test {
namespace {

using test::surface_of;

Vector3 random_direction(std::uint64_t number) {
  const auto unit = [&](std::uint64_t k) { return 2 * random_unit(21, 3 * number + k) - 1; };
  return Vector3(unit(0), unit(1), unit(2)).normalized();
}

TEST_CASE("Along any ray through a closed shape entries and exits alternate") {
  const test::Shape nested =
      test::merged(test::sphere(0.04, 3), test::turned_inside_out(test::sphere(0.02, 3)));
  for (const test::Shape& shape :
       {test::torus(0.035, 0.012, 48, 24), nested, test::box({0.05, 0.04, 0.06})}) {
    const OuterSurface surface = surface_of(shape);
    const Caster caster(surface);
    Column column;
    std::size_t marked = 0, most = 0;
    for (std::uint64_t i = 0; i < 4000; ++i) {
      const SupportPlane plane = vertex_support_plane(shape.vertices, random_direction(i));
      const PlaneCoordinates middle = project_on_plane(plane, Vector3::Zero());
      caster.cast(plane, middle.eta + 0.1 * (random_unit(22, 2 * i) - 0.5),
                  middle.omega + 0.1 * (random_unit(22, 2 * i + 1) - 0.5), column);
      marked += column.consistent ? 0 : 1;
      most = std::max(most, column.crossings.size());
      for (std::size_t k = 0; column.consistent && k < column.crossings.size(); ++k) {
        CHECK(column.crossings[k].entry == (k % 2 == 0));
        CHECK((k == 0 || column.crossings[k].depth >= column.crossings[k - 1].depth));
      }
    }
    CHECK(marked <= 4);
    CHECK(most >= 2);
  }
}

TEST_CASE("Rays straight through edges and corners stay consistent") {
  const test::Shape shape = test::box({0.04, 0.04, 0.04});
  const Caster caster(surface_of(shape));
  const SupportPlane plane = plane_with_normal({0, 0, 0.02}, Vector3::UnitZ());
  Column column;
  for (int i = -2; i <= 2; ++i) {
    for (int j = -2; j <= 2; ++j) {
      const Vector3 at(0.01 * i, 0.01 * j, 0.02);  // corners, edges, the diagonals of both faces
      const PlaneCoordinates place = project_on_plane(plane, at);
      caster.cast(plane, place.eta, place.omega, column);
      CHECK(column.consistent);
      CHECK((column.crossings.empty() || column.crossings.size() == 2));
      if (std::abs(i) < 2 && std::abs(j) < 2) {
        REQUIRE(column.crossings.size() == 2);
        CHECK(std::abs(column.crossings[0].depth) < 1e-9);
        CHECK(column.crossings[1].depth == Approx(0.04));
      }
    }
  }
}

TEST_CASE(
    "A vectorial column through a torus has four crossings at the closed form's depths (Fig. 2)") {
  const Caster caster(surface_of(test::torus(0.035, 0.012, 400, 200)));
  const SupportPlane plane = plane_with_normal({0.047, 0, 0}, Vector3::UnitX());
  const PlaneCoordinates place = project_on_plane(plane, {0.047, 0.0, 0.003});
  Column column;
  caster.cast(plane, place.eta, place.omega, column);
  REQUIRE(column.crossings.size() == 4);
  const double half = std::sqrt(0.012 * 0.012 - 0.003 * 0.003);
  const double depths[] = {0.012 - half, 0.012 + half, 0.082 - half, 0.082 + half};
  for (std::size_t k = 0; k < 4; ++k)
    CHECK(column.crossings[k].depth == Approx(depths[k]).margin(8e-6));
}

TEST_CASE("A ray into an open shape is marked") {
  test::Shape open = test::box({0.04, 0.04, 0.04});
  open.triangles.resize(10);
  OuterSurface surface;
  surface.vertices = open.vertices;
  surface.triangles = open.triangles;
  surface.solid_count = surface.triangles.size();
  const Caster caster(surface);
  const SupportPlane plane = plane_with_normal({0.02, 0, 0}, Vector3::UnitX());
  const PlaneCoordinates place = project_on_plane(plane, {0.02, 0.003, 0.004});
  Column column;
  caster.cast(plane, place.eta, place.omega, column);
  CHECK_FALSE(column.consistent);
  CHECK(column.crossings.size() == 1);
}

TEST_CASE("The baker's closest point is the sphere's, on both sides") {
  const Caster caster(surface_of(test::sphere(0.04, 5)));
  for (std::uint64_t i = 0; i < 500; ++i) {
    const Vector3 direction = random_direction(i);
    const double distance = 0.004 * (random_unit(23, i) - 0.5);
    const ClosestPoint found = caster.closest((0.04 + distance) * direction);
    CHECK(found.distance == Approx(distance).margin(2e-5));
    CHECK(found.direction.dot(direction) > (std::abs(found.distance) > 1e-4 ? 0.99 : -1.0));
  }
}

TEST_CASE("The triangles within a radius are those that brute force finds") {
  const OuterSurface surface = surface_of(test::torus(0.035, 0.012, 40, 20));
  const Caster caster(surface);
  std::vector<std::uint32_t> found;
  for (std::uint64_t i = 0; i < 50; ++i) {
    const Vector3 point = 0.04 * random_direction(i);
    caster.within(point, 0.008, found);
    std::vector<std::uint32_t> expected;
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
      Caster single([&] {
        OuterSurface one;
        one.vertices = {caster.corner(t, 0), caster.corner(t, 1), caster.corner(t, 2)};
        one.triangles = {{0, 1, 2}};
        one.solid_count = 1;
        return one;
      }());
      if (std::abs(single.closest(point).distance) <= 0.008) expected.push_back(t);
      if (t > 60) break;
    }
    found.erase(std::remove_if(found.begin(), found.end(), [](std::uint32_t t) { return t > 61; }),
                found.end());
    CHECK(found == expected);
  }
}

TEST_CASE("A place inside is told so where the end of a wall before a closed gap is nearest") {
  // The lower top ends 1.3 um within the upper wall, which begins 2 um above it; no wall between.
  const double foot = 0.005, end = foot - 1.3e-6;
  test::Shape shape = test::moved(test::box({0.02, 0.02, 0.01}), {0, 0, -0.005});
  const auto drop_flat = [](test::Shape& box, double height) {
    std::erase_if(box.triangles, [&](const auto& triangle) {
      return std::all_of(triangle.begin(), triangle.end(), [&](std::uint32_t corner) {
        return std::abs(box.vertices[corner].z() - height) < 1e-9;
      });
    });
  };
  drop_flat(shape, 0);
  test::Shape upper = test::moved(test::box({2 * foot, 2 * foot, 0.01}), {0, 0, 0.005 + 2e-6});
  drop_flat(upper, 2e-6);
  shape = test::merged(shape, upper);
  const auto first = static_cast<std::uint32_t>(shape.vertices.size());
  for (const double half : {0.01, end}) {
    for (const auto& [x, y] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
      shape.vertices.emplace_back(half * x, half * y, 0);
    }
  }
  for (std::uint32_t k = 0; k < 4; ++k) {
    const std::uint32_t next = (k + 1) % 4;
    shape.triangles.push_back({first + k, first + next, first + 4 + next});
    shape.triangles.push_back({first + k, first + 4 + next, first + 4 + k});
  }
  const Caster caster(surface_of(shape));
  for (const double x : {-0.0045, -0.0042, 0.0042, 0.0045}) {
    for (const double height : {1e-6, 3e-6, 6e-6}) {
      CHECK(caster.closest({x, 0.0011, height}).solid < 0);
      CHECK(caster.closest({0.0011, x, height}).solid < 0);
    }
    CHECK(caster.closest({2 * x, 0.0011, 1e-3}).solid > 0);
  }
}

}  // namespace
}  // namespace spm::baker::cast_test
