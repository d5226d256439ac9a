// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <random>

#include "common/base/octahedral.hpp"
#include "common/surface/support_plane_mapping.hpp"

namespace spm::support_plane_test {
namespace {

Vector3 random_vector(std::mt19937_64& bits) {
  const auto unit = [&] { return static_cast<double>(bits() >> 11U) * 0x1p-53 * 2 - 1; };
  return {unit(), unit(), unit()};
}

TEST_CASE("A point and its plane coordinates determine each other (eq. 1 and S_SP)") {
  std::mt19937_64 bits(7);
  for (int i = 0; i < 200; ++i) {
    const SupportPlane plane =
        plane_with_normal(random_vector(bits), random_vector(bits).normalized());
    const Vector3 point = random_vector(bits);
    const PlaneCoordinates place = project_on_plane(plane, point);
    CHECK(place.depth == Approx(support_plane_depth(plane, point)).margin(1e-14));
    const Vector3 back = support_plane_point(plane, place.eta, place.omega) - place.depth * plane.n;
    CHECK((back - point).norm() < 1e-14);
  }
}

TEST_CASE("Every normal is completed to a right-handed orthonormal basis") {
  std::mt19937_64 bits(8);
  for (int i = 0; i < 300; ++i) {
    Vector3 normal = random_vector(bits).normalized();
    if (i < 6) normal = (i % 2 == 0 ? 1.0 : -1.0) * Vector3::Unit(i / 2);
    const SupportPlane plane = plane_with_normal(Vector3::Zero(), normal);
    CHECK((plane.n - normal).norm() < 1e-15);
    CHECK((plane.u.cross(plane.v) - plane.n).norm() < 1e-14);
    CHECK(std::abs(plane.u.norm() - 1) < 1e-14);
  }
}

TEST_CASE("The mapping M_O(v) finds the plane most parallel to v (Definition 2)") {
  std::mt19937_64 bits(9);
  std::vector<SupportPlane> planes;
  for (int i = 0; i < 40; ++i) {
    planes.push_back(plane_with_normal(Vector3::Zero(), random_vector(bits).normalized()));
  }
  for (int i = 0; i < 200; ++i) {
    const Vector3 direction = 3 * random_vector(bits);
    const std::size_t found = support_plane_mapping(planes, direction);
    for (const SupportPlane& plane : planes) {
      CHECK(planes[found].n.dot(direction) >= plane.n.dot(direction));
    }
  }
}

TEST_CASE("A vertex-based plane touches the object and leaves it on its negative side") {
  std::mt19937_64 bits(10);
  std::vector<Vector3> points;
  for (int i = 0; i < 60; ++i) points.push_back(random_vector(bits));
  for (int i = 0; i < 100; ++i) {
    const SupportPlane plane = vertex_support_plane(points, random_vector(bits).normalized());
    double least = 1e9;
    for (const Vector3& point : points) least = std::min(least, support_plane_depth(plane, point));
    CHECK(std::abs(least) < 1e-15);
  }
}

TEST_CASE("Thirty bits keep a direction within a hundredth of a degree") {
  std::mt19937_64 bits(11);
  for (int i = 0; i < 2000; ++i) {
    const Vector3 direction = random_vector(bits).normalized();
    const Vector3 back = unpack_octahedral(pack_octahedral(direction));
    CHECK(back.norm() == Approx(1));
    CHECK(back.cross(direction).norm() < 1.8e-4);
    CHECK(back.dot(direction) > 0);
  }
}

}  // namespace
}  // namespace spm::support_plane_test
