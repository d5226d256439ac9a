// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <random>

#include "common/surface/closest_on_map.hpp"
#include "common/surface/closest_on_triangle.hpp"
#include "common/surface/support_plane_mapping.hpp"
#include "tests/support/asset_by_hand.hpp"

namespace spm::closest_test {
namespace {

double unit(std::mt19937_64& bits) { return static_cast<double>(bits() >> 11U) * 0x1p-53; }

TEST_CASE("The closest point of a triangle is no farther than any point of it") {
  std::mt19937_64 bits(3);
  const auto vector = [&] { return Vector3(unit(bits) - 0.5, unit(bits) - 0.5, unit(bits) - 0.5); };
  for (int i = 0; i < 300; ++i) {
    const Vector3 a = vector(), b = vector(), c = vector(), point = 2 * vector();
    const Vector3 found = closest_on_triangle(point, a, b, c);
    const double distance = (found - point).norm();
    double least = 1e9;
    for (int x = 0; x <= 20; ++x) {
      for (int y = 0; x + y <= 20; ++y) {
        least = std::min(least, (a + x / 20.0 * (b - a) + y / 20.0 * (c - a) - point).norm());
      }
    }
    CHECK(distance <= least + 1e-12);
    CHECK(distance >= least - 0.08);
  }
}

TEST_CASE("Degenerate triangles have a closest point too") {
  const Vector3 a(0, 0, 0), b(1, 0, 0), point(0.25, 1, 0);
  CHECK((closest_on_triangle(point, a, b, b) - Vector3(0.25, 0, 0)).norm() < 1e-15);
  CHECK((closest_on_triangle(point, a, b, Vector3(0.5, 0, 0)) - Vector3(0.25, 0, 0)).norm() <
        1e-15);
  CHECK((closest_on_triangle(point, a, a, a) - a).norm() < 1e-15);
}

/// A sphere's cap of radius R whose pole touches the plane's origin.
test::MapByHand cap_map(double radius, double half_width, std::uint32_t samples) {
  test::MapByHand made = test::map_by_hand(
      0, samples, samples, 1, -half_width, -half_width, 2 * half_width / (samples - 1),
      [=](std::uint32_t, double eta, double omega) {
        return radius - std::sqrt(radius * radius - eta * eta - omega * omega);
      });
  made.map.samples = made.samples.data();
  made.map.layer_offsets = made.offsets.data();
  made.map.mask = made.mask.data();
  return made;
}

TEST_CASE("The closest point on a cap's map has the sphere's distance and direction") {
  const double radius = 0.05;
  const test::MapByHand made = cap_map(radius, 0.02, 65);
  const SupportPlane plane = plane_with_normal({0, 0, radius}, Vector3::UnitZ());
  std::mt19937_64 bits(4);
  for (int i = 0; i < 2000; ++i) {
    const double along = 0.33 * unit(bits), around = 6.28 * unit(bits);
    const Vector3 direction(std::sin(along) * std::cos(around), std::sin(along) * std::sin(around),
                            std::cos(along));
    const double distance = -0.002 + 0.0025 * unit(bits);
    const MapClosestPoint closest_point =
        closest_on_map(made.map, 0, plane, (radius + distance) * direction);
    REQUIRE(closest_point.valid);
    CHECK(closest_point.distance == Approx(distance).margin(3e-6));
    CHECK(normal_at(made.map, 0, plane, closest_point.cell).dot(direction) > std::cos(0.01));
  }
}

TEST_CASE(
    "A closest point beyond the map is clamped to its border, and never closer than the surface") {
  const test::MapByHand made = cap_map(0.05, 0.01, 17);
  const SupportPlane plane = plane_with_normal({0, 0, 0.05}, Vector3::UnitZ());
  const Vector3 point(0.03, 0, 0.0405);
  const MapClosestPoint closest_point = closest_on_map(made.map, 0, plane, point);
  CHECK(std::abs(closest_point.distance) > std::abs(point.norm() - 0.05));
  CHECK(std::abs(closest_point.distance) < 0.03);
}

TEST_CASE("A closest point in a masked cell is not valid") {
  test::MapByHand made = cap_map(0.05, 0.02, 9);
  std::fill(made.mask.begin(), made.mask.end(), 0U);
  const SupportPlane plane = plane_with_normal({0, 0, 0.05}, Vector3::UnitZ());
  CHECK_FALSE(closest_on_map(made.map, 0, plane, {0.001, 0.002, 0.049}).valid);
}

}  // namespace
}  // namespace spm::closest_test
