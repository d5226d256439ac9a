// SPDX-License-Identifier: Apache-2.0
#include "common/contour/contour_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <numbers>
#include <utility>

#include "common/query/query.hpp"
#include "tests/servo/support/shape_asset.hpp"
#include "tests/support/shapes.hpp"

namespace contour_mesh_test {

using namespace spm;

namespace {

constexpr int cells = 24;

ContourMesh mesh_of(const Asset& asset) {
  const AssetTables tables = tables_of(asset);
  return contour_mesh(tables.view(), cells);
}

Vector3 corner(const ContourMesh& mesh, std::size_t number) {
  const auto& at = mesh.vertices[number];
  return {at[0], at[1], at[2]};
}

double volume_of(const ContourMesh& mesh) {
  double volume = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    volume +=
        corner(mesh, mesh.triangles[i])
            .dot(corner(mesh, mesh.triangles[i + 1]).cross(corner(mesh, mesh.triangles[i + 2])));
  }
  return volume / 6;
}

/// How often each side of a triangle is run through, by its two corners.
std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides_of(const ContourMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      ++sides[{mesh.triangles[i + k], mesh.triangles[i + (k + 1) % 3]}];
    }
  }
  return sides;
}

/// Sides that no triangle beside runs through the other way.
int open_sides(const ContourMesh& mesh) {
  auto sides = sides_of(mesh);
  int open = 0;
  for (const auto& [side, times] : sides_of(mesh)) {
    open += std::max(0, times - sides[{side.second, side.first}]);
  }
  return open;
}

test::Shape turned(test::Shape shape) {
  const Eigen::AngleAxisd turn(0.5, Vector3(1, 2, 3).normalized());
  for (Vector3& vertex : shape.vertices) vertex = turn * vertex;
  return shape;
}

/// The lower half of a sphere's shell, open at the top.
test::Shape bowl(double radius, double wall) {
  constexpr int around = 24, rows = 6;
  test::Shape shape;
  for (const double r : {radius, radius - wall}) {
    for (int row = 1; row <= rows; ++row) {
      const double polar = std::numbers::pi / 2 * row / rows;
      for (int i = 0; i < around; ++i) {
        const double turn = 2 * std::numbers::pi * i / around;
        shape.vertices.emplace_back(r * std::sin(polar) * std::cos(turn),
                                    r * std::sin(polar) * std::sin(turn), -r * std::cos(polar));
      }
    }
  }
  const auto at = [&](int shell, int row, int i) {
    return static_cast<std::uint32_t>((shell * rows + row) * around + i % around);
  };
  const auto bottom = static_cast<std::uint32_t>(shape.vertices.size());
  shape.vertices.emplace_back(0, 0, -radius);
  shape.vertices.emplace_back(0, 0, wall - radius);
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    shape.triangles.push_back({a, b, c});
    shape.triangles.push_back({a, c, d});
  };
  for (int i = 0; i < around; ++i) {
    shape.triangles.push_back({bottom, at(0, 0, i + 1), at(0, 0, i)});
    shape.triangles.push_back({bottom + 1, at(1, 0, i), at(1, 0, i + 1)});
    for (int row = 0; row + 1 < rows; ++row) {
      quad(at(0, row, i), at(0, row, i + 1), at(0, row + 1, i + 1), at(0, row + 1, i));
      quad(at(1, row, i), at(1, row + 1, i), at(1, row + 1, i + 1), at(1, row, i + 1));
    }
    quad(at(0, rows - 1, i), at(0, rows - 1, i + 1), at(1, rows - 1, i + 1), at(1, rows - 1, i));
  }
  return shape;
}

double volume_of(const test::Shape& shape) {
  double volume = 0;
  for (const auto& [a, b, c] : shape.triangles) {
    volume += shape.vertices[a].dot(shape.vertices[b].cross(shape.vertices[c]));
  }
  return volume / 6;
}

}  // namespace

TEST_CASE("Walls that are thinner than a cell of the grid are drawn whole, both sides apart") {
  // The grid's cell is 1.7 to 2 mm.
  const double wall = GENERATE(0.8e-3, 0.3e-3, 0.1e-3);
  const bool is_bowl = GENERATE(false, true);
  const test::Shape shape =
      is_bowl ? bowl(0.02, wall) : turned(test::plate(Vector3(0.04, 0.04, wall)));
  const Asset asset = test::shape_asset(shape);
  const AssetTables tables = tables_of(asset);
  const ContourMesh mesh = contour_mesh(tables.view(), cells);
  REQUIRE(mesh.cell > 1.5 * wall);
  CHECK(open_sides(mesh) == 0);
  CHECK(volume_of(mesh) == Approx(volume_of(shape)).epsilon(0.1));
  int off = 0;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Answer answer = query_point(tables.view(), corner(mesh, i));
    off += answer.status != Status::exact || std::abs(answer.distance) > 0.1 * mesh.cell ? 1 : 0;
  }
  CHECK(off < 0.04 * static_cast<double>(mesh.vertices.size()));
}

TEST_CASE("The mesh of a box is closed, faces outward and has the box's volume and its corners") {
  const ContourMesh mesh = mesh_of(test::box_asset(0.04));
  REQUIRE(mesh.triangles.size() > 3000);
  for (const auto& [side, times] : sides_of(mesh)) REQUIRE(times == 1);
  CHECK(open_sides(mesh) == 0);
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
  const ContourMesh mesh = contour_mesh(tables.view(), cells);
  REQUIRE(!mesh.vertices.empty());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Answer answer = query_point(tables.view(), corner(mesh, i));
    REQUIRE(answer.status == Status::exact);
    REQUIRE(std::abs(answer.distance) < 1e-3 * mesh.cell);
  }
}

}  // namespace contour_mesh_test
