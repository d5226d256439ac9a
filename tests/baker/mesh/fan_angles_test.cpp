// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/fan_angles.hpp"

#include <catch2/catch.hpp>
#include <numbers>

#include "common/base/random.hpp"
#include "tests/baker/mesh/triangle_winding.hpp"

namespace fan_angles_test {

using namespace spm;
using namespace spm::baker;

namespace {

/// Edges whose corners are about `size` apart, the `count` of them that a seed gives.
std::vector<DirectedEdge> random_edges(std::uint64_t seed, std::size_t count, double size) {
  std::vector<DirectedEdge> edges(count);
  std::uint64_t drawn = 0;
  for (DirectedEdge& edge : edges) {
    for (Vector3& end : edge) {
      for (int axis = 0; axis < 3; ++axis) end[axis] = size * (random_unit(seed, drawn++) - 0.5);
    }
  }
  return edges;
}

double by_triangles(const std::vector<DirectedEdge>& edges, const Vector3& apex,
                    const Vector3& point) {
  double turns = 0;
  for (const auto& [from, to] : edges) turns += test::triangle_winding(point, apex, from, to);
  return 2 * std::numbers::pi * turns;
}

}  // namespace

TEST_CASE("The angles of a fan are those of its triangles, near and far, for any count of edges") {
  const Vector3 apex(0.001, -0.002, 0.003);
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const std::vector<DirectedEdge> edges = random_edges(seed, seed % 23, 0.1);
    const double far = seed % 2 == 0 ? 0.1 : 10;
    const Vector3 point =
        far * (Vector3(random_unit(seed, 1000), random_unit(seed, 1001), random_unit(seed, 1002)) -
               Vector3(0.5, 0.5, 0.5));
    AngleSum sum;
    sum.add_fan(edge_blocks(edges), apex, point);
    CHECK(sum.total() == Approx(by_triangles(edges, apex, point)).margin(1e-10));
  }
}

TEST_CASE("The angles of triangles are theirs, near and far, and in a corner none") {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const std::vector<DirectedEdge> edges = random_edges(seed, 1 + seed % 11, 0.1);
    const std::vector<DirectedEdge> apexes = random_edges(seed + 1000, 1 + seed % 11, 0.1);
    std::vector<std::array<Vector3, 3>> triangles;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      triangles.push_back({apexes[i][0], edges[i][0], edges[i][1]});
    }
    for (const Vector3& point :
         {Vector3(0.01, 0.02, -0.03), Vector3(3, 2, 1), triangles[0][seed % 3]}) {
      double turns = 0;
      for (const auto& [a, b, c] : triangles) turns += test::triangle_winding(point, a, b, c);
      AngleSum sum;
      sum.add_triangles(triangle_blocks(triangles), point);
      CHECK(sum.total() == Approx(2 * std::numbers::pi * turns).margin(1e-9));
    }
  }
}

TEST_CASE("Several fans add up in one sum, also where their angles make many turns") {
  const Vector3 point(0.004, 0.001, -0.002);
  AngleSum sum;
  double triangles = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    // A fan that is turned about so that it adds and does not take away.
    std::vector<DirectedEdge> edges = random_edges(seed, 4, 0.1);
    const Vector3 apex(0, 0.002, 0.001);
    for (auto& [from, to] : edges) {
      if (test::triangle_winding(point, apex, from, to) < 0) std::swap(from, to);
    }
    sum.add_fan(edge_blocks(edges), apex, point);
    triangles += by_triangles(edges, apex, point);
  }
  CHECK(triangles > 4 * std::numbers::pi);
  CHECK(sum.total() == Approx(triangles).margin(1e-10));
}

TEST_CASE("No edges make no angle") {
  AngleSum sum;
  sum.add_fan({}, Vector3(0, 0, 0), Vector3(1, 0, 0));
  CHECK(sum.total() == 0);
}

}  // namespace fan_angles_test
