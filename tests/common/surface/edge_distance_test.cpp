// SPDX-License-Identifier: Apache-2.0
// The distance from two surfaces that meet at an edge.
#include "common/surface/edge_distance.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "common/base/vector.hpp"
#include "tests/support/random.hpp"

namespace spm::edge_distance_test {
namespace {

/// A wedge about the z axis: the places behind both planes through it.
struct Wedge {
  Vector3 first, second;  ///< unit normals, outwards

  /// Its normals are so many radians apart, below pi.
  explicit Wedge(double apart)
      : first(std::cos(apart / 2), std::sin(apart / 2), 0),
        second(std::cos(apart / 2), -std::sin(apart / 2), 0) {}

  /// Outside it: the least distance from both half planes, by their closest points.
  [[nodiscard]] double distance(const Vector3& place) const {
    double least = std::hypot(place[0], place[1]);
    for (const auto& [normal, other] : {std::pair{first, second}, std::pair{second, first}}) {
      const Vector3 foot = place - place.dot(normal) * normal;
      if (foot.dot(other) <= 0) least = std::min(least, std::abs(place.dot(normal)));
    }
    return least;
  }
};

}  // namespace

TEST_CASE("In front of a convex edge the distance is that of the nearest half plane or the edge") {
  test::RandomTwister random(3);
  for (int trial = 0; trial < 20000; ++trial) {
    const Wedge wedge(random.between(0.1, 3));
    const Vector3 place = random.vector(1);
    const double d1 = place.dot(wedge.first), d2 = place.dot(wedge.second);
    const EdgeDistance told = edge_distance(d1, d2, wedge.first.dot(wedge.second));
    const Vector3 direction = told.first * wedge.first + told.second * wedge.second;
    INFO(place.transpose() << ", normals " << wedge.first.dot(wedge.second));
    CHECK(direction.norm() == Approx(1).epsilon(1e-9));
    if (d1 <= 0 && d2 <= 0) {
      CHECK(told.distance == std::max(d1, d2));
    } else {
      CHECK(told.distance == Approx(wedge.distance(place)).margin(1e-12));
      const Vector3 closest = place - told.distance * direction;
      CHECK(std::max(closest.dot(wedge.first), closest.dot(wedge.second)) < 1e-9);
    }
  }
}

TEST_CASE("Where an edge becomes what is nearest the distance does not jump, nor its direction") {
  for (const double apart : {0.05, 0.5, 1.5, 2.9}) {
    const double cosine = std::cos(apart);
    constexpr double step = 1e-7;
    const EdgeDistance before = edge_distance(1, cosine - step, cosine),
                       behind = edge_distance(1, cosine + step, cosine);
    CHECK(std::abs(behind.distance - before.distance) < 1e-9);
    CHECK(std::abs(behind.first - before.first) < 1e-4);
    CHECK(std::abs(behind.second - before.second) < 1e-4);
  }
}

TEST_CASE("Two surfaces of one direction have no edge") {
  for (const double cosine : {1.0, 1 - 1e-9, -1.0}) {
    const EdgeDistance told = edge_distance(2, 1.9999999999, cosine);
    CHECK(told.distance == 2);
    CHECK(told.first == 1);
    CHECK(told.second == 0);
  }
}

}  // namespace spm::edge_distance_test
