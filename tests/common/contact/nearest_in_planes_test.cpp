// SPDX-License-Identifier: Apache-2.0
#include "common/contact/nearest_in_planes.hpp"

#include <catch2/catch.hpp>
#include <random>

namespace spm::nearest_in_planes_test {
namespace {

HalfSpaces spaces_of(std::initializer_list<HalfSpace> planes) {
  HalfSpaces spaces;
  for (const HalfSpace& plane : planes) spaces.add(plane);
  return spaces;
}

TEST_CASE("A point that is in all half-spaces is left where it is") {
  CHECK(nearest_in_planes({}, {1, 2, 3}) == Vector3(1, 2, 3));
  CHECK(nearest_in_planes(spaces_of({half_space_above(Vector3::UnitZ(), 2)}), {1, 2, 3}) ==
        Vector3(1, 2, 3));
}

TEST_CASE("One, two and three planes leave a closest point, a line and a corner") {
  const HalfSpace x = half_space_above(Vector3::UnitX(), 1);
  const HalfSpace y = half_space_above(Vector3::UnitY(), 2);
  const HalfSpace z = half_space_above(Vector3::UnitZ(), 3);
  CHECK((nearest_in_planes(spaces_of({x}), {0, 5, 7}) - Vector3(1, 5, 7)).norm() < 1e-12);
  CHECK((nearest_in_planes(spaces_of({x, y}), {0, 0, 7}) - Vector3(1, 2, 7)).norm() < 1e-12);
  CHECK((nearest_in_planes(spaces_of({x, y, z}), {0, 0, 0}) - Vector3(1, 2, 3)).norm() < 1e-12);
  // A plane that does not hold the point back has no effect.
  CHECK((nearest_in_planes(spaces_of({x, y, z}), {0, 9, 9}) - Vector3(1, 9, 9)).norm() < 1e-12);
}

TEST_CASE("No place in the half-spaces is nearer than the one that is found") {
  std::mt19937_64 bits(5);
  const auto random = [&bits] { return static_cast<double>(bits() >> 11U) * 0x1p-52 - 1; };
  const auto vector = [&random] { return Vector3(random(), random(), random()); };
  for (int trial = 0; trial < 300; ++trial) {
    HalfSpaces spaces;
    for (int k = 0; k < 3; ++k) {
      const Vector3 normal = vector().normalized();
      spaces.add(half_space_above(normal, random()));
    }
    const Vector3 point = 2 * vector();
    const Vector3 found = nearest_in_planes(spaces, point);
    for (std::size_t k = 0; k < 3; ++k) {
      CHECK(spaces.planes[k].normal.dot(found) <= spaces.planes[k].offset + 1e-6);
    }
    for (int other = 0; other < 200; ++other) {
      const Vector3 place = found + 0.5 * vector();
      bool in = true;
      for (std::size_t k = 0; k < 3; ++k) {
        in = in && spaces.planes[k].normal.dot(place) <= spaces.planes[k].offset;
      }
      if (in) CHECK((place - point).norm() >= (found - point).norm() - 1e-6);
    }
  }
}

TEST_CASE("Planes that face each other give a finite place") {
  const Vector3 found = nearest_in_planes(
      spaces_of({half_space_above(Vector3::UnitZ(), 1), half_space_above(-Vector3::UnitZ(), 1)}),
      {0, 0, 0});
  CHECK(found.allFinite());
}

}  // namespace
}  // namespace spm::nearest_in_planes_test
