// SPDX-License-Identifier: Apache-2.0
#include "servo/view/surface_mesh.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>
#include <map>
#include <utility>

#include "common/query/query.hpp"
#include "tests/servo/support/shape_asset.hpp"
#include "tests/support/shapes.hpp"

namespace surface_mesh_test {

using namespace spm;
using namespace spm::servo;

namespace {

constexpr int cells = 24;

SurfaceMesh mesh_of(const Asset& asset) {
  const AssetTables tables = tables_of(asset);
  return surface_mesh(tables.view(), cells);
}

Vector3 corner(const SurfaceMesh& mesh, std::size_t number) {
  const auto& at = mesh.vertices[number];
  return {at[0], at[1], at[2]};
}

double volume_of(const SurfaceMesh& mesh) {
  double volume = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    volume +=
        corner(mesh, mesh.triangles[i])
            .dot(corner(mesh, mesh.triangles[i + 1]).cross(corner(mesh, mesh.triangles[i + 2])));
  }
  return volume / 6;
}

}  // namespace

TEST_CASE("The mesh of a box is closed, faces outward and has the box's volume and its corners") {
  const SurfaceMesh mesh = mesh_of(test::box_asset(0.04));
  REQUIRE(mesh.triangles.size() > 3000);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      ++edges[{mesh.triangles[i + k], mesh.triangles[i + (k + 1) % 3]}];
    }
  }
  for (const auto& [edge, times] : edges) {
    REQUIRE(times == 1);
    REQUIRE(edges.count({edge.second, edge.first}) == 1);
  }
  CHECK(volume_of(mesh) == Approx(0.04 * 0.04 * 0.04).epsilon(2e-3));
  double farthest = 0;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    farthest = std::max(farthest, corner(mesh, i).norm());
  }
  // Corners are not cut off: the grid's cell is 1.9 mm.
  CHECK(farthest == Approx(std::sqrt(3) * 0.02).epsilon(5e-3));
}

TEST_CASE("The vertices of a round surface lie on it, by the field that forces come from") {
  const Asset asset = test::shape_asset(test::sphere(0.02, 2));
  const AssetTables tables = tables_of(asset);
  const SurfaceMesh mesh = surface_mesh(tables.view(), cells);
  REQUIRE(!mesh.vertices.empty());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Answer answer = query_point(tables.view(), corner(mesh, i));
    REQUIRE(answer.status == Status::exact);
    REQUIRE(std::abs(answer.distance) < 0.1 * mesh.cell);
  }
}

TEST_CASE("A mesh's bytes are its counts, vertices and corners") {
  SurfaceMesh mesh;
  mesh.vertices = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  mesh.triangles = {0, 1, 2};
  const std::string bytes = to_bytes(mesh);
  REQUIRE(bytes.size() == 8 + 36 + 12);
  std::array<std::uint32_t, 2> counts{};
  std::memcpy(counts.data(), bytes.data(), 8);
  CHECK(counts == std::array<std::uint32_t, 2>{3, 1});
  float last = 0;
  std::memcpy(&last, bytes.data() + 40, 4);
  CHECK(last == 9);
}

}  // namespace surface_mesh_test
