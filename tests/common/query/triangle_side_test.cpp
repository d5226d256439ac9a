// SPDX-License-Identifier: Apache-2.0
#include "common/query/triangle_side.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "common/surface/closest_on_triangle.hpp"

namespace spm::triangle_side_test {
namespace {

constexpr double rounding = 1e-6;

using Triangle = std::array<Vector3, 3>;
using Triangles = std::vector<Triangle>;

Vector3 normal_of(const Triangle& t) { return (t[1] - t[0]).cross(t[2] - t[0]).normalized(); }

double side_of(const Triangles& triangles, const Vector3& point) {
  TriangleSide side(rounding);
  for (const Triangle& t : triangles) {
    const Vector3 closest_point = closest_on_triangle(point, t[0], t[1], t[2]);
    const double distance = (point - closest_point).norm();
    const double along = normal_of(t).dot(point - closest_point);
    side.add(t, closest_point, distance, along);
  }
  return side.side();
}

/// Whether a point is inside: there the triangles cover the full solid angle around it (van
/// Oosterom and Strackee 1983).
bool inside(const Triangles& triangles, const Vector3& point) {
  double turn = 0;
  for (const Triangle& t : triangles) {
    const Vector3 a = t[0] - point, b = t[1] - point, c = t[2] - point;
    const double below = a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() +
                         b.dot(c) * a.norm() + c.dot(a) * b.norm();
    turn += 2 * std::atan2(a.dot(b.cross(c)), below);
  }
  return turn > 2 * std::numbers::pi;
}

/// A ball whose corners all lie at different distances: full of spikes, pits and saddles.
Triangles spiky_ball(std::mt19937& random) {
  constexpr std::size_t rings = 6, around = 9;
  std::uniform_real_distribution<double> radius(0.01, 0.03);
  std::vector<std::vector<Vector3>> corner(rings + 1);
  for (std::size_t i = 0; i <= rings; ++i) {
    const double polar = std::numbers::pi * static_cast<double>(i) / rings;
    const bool pole = i == 0 || i == rings;
    for (std::size_t j = 0; j < around; ++j) {
      const double turn = 2 * std::numbers::pi * static_cast<double>(j) / around;
      const Vector3 towards(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn),
                            std::cos(polar));
      corner[i].push_back(pole ? 0.02 * Vector3(0, 0, i == 0 ? 1 : -1)
                               : Vector3(radius(random) * towards));
    }
  }
  Triangles result;
  for (std::size_t i = 0; i < rings; ++i) {
    for (std::size_t j = 0; j < around; ++j) {
      const std::size_t next = (j + 1) % around;
      if (i > 0) result.push_back({corner[i][j], corner[i + 1][j], corner[i][next]});
      if (i + 1 < rings) {
        result.push_back({corner[i][next], corner[i + 1][j], corner[i + 1][next]});
      }
    }
  }
  return result;
}

TEST_CASE("The triangles around a closest point tell the side at spikes, pits and saddles") {
  for (unsigned seed = 0; seed < 12; ++seed) {
    std::mt19937 random(seed);
    const Triangles ball = spiky_ball(random);
    std::uniform_int_distribution<std::size_t> which(0, ball.size() - 1);
    std::normal_distribution<double> away(0, 0.002);
    for (int i = 0; i < 4000; ++i) {
      const Vector3 point =
          ball[which(random)][0] + Vector3(away(random), away(random), away(random));
      const bool truth = inside(ball, point);
      INFO("seed " << seed << ", point " << i);
      REQUIRE((side_of(ball, point) < 0) == truth);
    }
  }
}

TEST_CASE("What the triangles tell does not depend on their order") {
  std::mt19937 random(7);
  Triangles ball = spiky_ball(random);
  std::normal_distribution<double> away(0, 0.002);
  for (int i = 0; i < 200; ++i) {
    const Vector3 point = ball[0][0] + Vector3(away(random), away(random), away(random));
    const bool told = side_of(ball, point) > 0;
    std::shuffle(ball.begin(), ball.end(), random);
    CHECK((side_of(ball, point) > 0) == told);
  }
}

/// A sharp ridge along y, solid below, whose left face is cut in two at a corner on the ridge that
/// rounding has moved.
Triangles cut_ridge(double moved) {
  const Vector3 front(0, -0.01, 0), back(0, 0.01, 0), middle(0, 1e-4, moved);
  const Vector3 left(-0.001, 0, -0.01), right(0.004, 0, -0.01);
  return {{front, middle, left}, {middle, back, left}, {back, front, right}};
}

TEST_CASE("An edge of which one face was cut and rounded still has two faces") {
  for (const double moved : {0.0, 2e-7, -2e-7}) {
    const Triangles ridge = cut_ridge(moved);
    REQUIRE(normal_of(ridge[0]).x() < 0);
    REQUIRE(normal_of(ridge[2]).x() > 0);
    // Over the ridge, where the steeper face alone would say inside.
    for (const double y : {-0.005, -0.002, 0.001, 0.006}) {
      for (const double height : {1e-4, 5e-4}) {
        const Vector3 point(0.9 * height, y, height);
        const Vector3 other(-1.5 * height, y, 0.02 * height);
        INFO("moved " << moved << " y " << y << " height " << height);
        CHECK(side_of(ridge, point) > 0);
        CHECK(side_of(ridge, other) > 0);
      }
    }
  }
}

/// Two thin fins that meet at an edge along y, from which both go away from x; rounding has put one
/// face of the first behind its other.
TEST_CASE("Fins whose faces rounding has swapped at an edge are told by their sum") {
  const Vector3 front(0, -0.01, 0), back(0, 0.01, 0);
  const auto ray = [](double degrees) {
    const double turn = degrees * std::numbers::pi / 180;
    return Vector3(0.01 * std::cos(turn), 0, 0.01 * std::sin(turn));
  };
  const auto face = [&](double degrees, bool up) {
    return up ? Triangle{front, ray(degrees), back} : Triangle{back, ray(degrees), front};
  };
  const Vector3 point(1e-3, 0, 0);
  for (const double swapped : {0.0, 1e-3, 0.05}) {
    const Triangles fins{face(119.8 + swapped, false), face(119.8, true), face(210, true),
                         face(205, false)};
    INFO("swapped by " << swapped);
    CHECK(side_of(fins, point) > 0);
  }
}

TEST_CASE("A sheet without thickness tells no side") {
  const Triangle up{Vector3(0, 0, 0), Vector3(0.01, 0, 0), Vector3(0, 0.01, 0)};
  const Triangle down{up[1], up[0], up[2]};
  for (const Vector3& point :
       {Vector3(0.002, 0.003, 1e-3), Vector3(0.002, 0.003, -1e-3), Vector3(-1e-3, 2e-3, 4e-4)}) {
    CHECK(side_of({up, down}, point) == 0);
  }
}

TEST_CASE("A triangle alone tells the side where it faces a point, not beside its edge") {
  const Triangle up{Vector3(0, 0, 0), Vector3(0.01, 0, 0), Vector3(0, 0.01, 0)};
  CHECK(side_of({up}, {0.002, 0.003, 1e-3}) > 0);
  CHECK(side_of({up}, {0.002, 0.003, -1e-3}) < 0);
  CHECK(side_of({up}, {0.002, -1e-3, 1e-3}) == 0);
  CHECK(side_of({up}, {-1e-3, -1e-3, 1e-3}) == 0);
  CHECK(side_of({}, {0, 0, 0}) == 0);
}

}  // namespace
}  // namespace spm::triangle_side_test
