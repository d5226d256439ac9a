// SPDX-License-Identifier: GPL-3.0-or-later
// What two fields and their edge tell over a cube stays within its bound.
#include "baker/field/edge_bound.hpp"

#include <Eigen/Geometry>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "common/surface/edge_distance.hpp"
#include "tests/support/random.hpp"

namespace spm::baker::edge_bound_test {
namespace {

/// Symmetric, of entries from -1 to 1.
Eigen::Matrix3d symmetric(test::RandomTwister& random) {
  const Vector3 d = random.vector(1), m = random.vector(1);
  Eigen::Matrix3d bend;
  bend << d[0], m[0], m[1], m[0], d[1], m[2], m[1], m[2], d[2];
  return bend;
}

/// A field with a normal that turns along one direction.
struct Turning {
  FieldBound bound;
  Vector3 axis, along;
  double rate = 0;  ///< rad/m

  Turning(test::RandomTwister& random, double half, double reach) {
    bound.normal = random.direction();
    axis = random.direction();
    along = random.direction();
    rate = random.between(0, 0.2) / half;
    bound.turn = rate * half * along.lpNorm<1>();
    bound.near.value = random.between(-reach, reach);
    bound.near.gradient = bound.normal + random.vector(0.2);
    bound.near.bend = random.between(0, 0.2) / half * symmetric(random);
    bound.off = random.between(0, 0.05) * half;
  }
  [[nodiscard]] double at(const Vector3& place, test::RandomTwister& random) const {
    return bound.near.at(place) + random.between(-1, 1) * bound.off;
  }
  [[nodiscard]] Vector3 normal_at(const Vector3& place) const {
    return Eigen::AngleAxisd(rate * along.dot(place), axis) * bound.normal;
  }
};

}  // namespace

TEST_CASE("What two fields and the edge between them tell is within its bound") {
  test::RandomTwister random(11);
  std::size_t edges = 0, apart = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const double half = 1e-4, reach = random.between(0, 10) * half;
    const Turning one(random, half, reach), two(random, half, reach);
    const bool larger = random.unit() < 0.5;
    const double sign = larger ? 1 : -1;
    const EdgeBound told = bound_at_edge({one.bound, two.bound}, half, larger);
    edges += told.edge ? 1 : 0;
    for (int k = 0; k < 200; ++k) {
      const Vector3 place = random.vector(half);
      const double first = sign * one.at(place, random), second = sign * two.at(place, random);
      const double value =
          sign *
          edge_distance(first, second, one.normal_at(place).dot(two.normal_at(place))).distance;
      const double beside = sign * std::max(first, second);
      if (!told.edge) {
        REQUIRE(value == beside);
        ++apart;
        continue;
      }
      const double off = value - told.near.at(place);
      REQUIRE(off >= -told.below);
      REQUIRE(off <= told.above);
      REQUIRE(sign * (value - beside) <= told.past);
    }
  }
  CHECK(edges > 500);
  CHECK(apart > 1000);
}

TEST_CASE("The value that a bound at an edge tells of the middle is exact") {
  test::RandomTwister random(12);
  for (int trial = 0; trial < 1000; ++trial) {
    const Turning one(random, 1e-4, 3e-4), two(random, 1e-4, 3e-4);
    const double cosine = one.bound.normal.dot(two.bound.normal);
    CHECK(bound_at_edge({one.bound, two.bound}, 1e-4, true).value ==
          Approx(edge_distance(one.bound.near.value, two.bound.near.value, cosine).distance));
  }
}

}  // namespace spm::baker::edge_bound_test
