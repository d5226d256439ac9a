// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numbers>
#include <utility>
#include <vector>

#include "baker/mesh/mesh.hpp"
#include "baker/mesh/mesh_edges.hpp"
#include "baker/mesh/winding_number.hpp"
#include "tests/baker/mesh/mesh_support.hpp"
#include "tests/support/shapes.hpp"

namespace spm::test::mesh_lids_test {
namespace {

using baker::Mesh;

/// A sphere of radius 1 without the triangles around a vertex.
[[nodiscard]] Shape holed_sphere(const std::vector<std::uint32_t>& vertices) {
  Shape shape = sphere(1, 4);
  std::erase_if(shape.triangles, [&](const auto& triangle) {
    return std::any_of(triangle.begin(), triangle.end(), [&](std::uint32_t corner) {
      return std::find(vertices.begin(), vertices.end(), corner) != vertices.end();
    });
  });
  return shape;
}

[[nodiscard]] Shape turned(Shape shape) {
  for (auto& triangle : shape.triangles) std::swap(triangle[1], triangle[2]);
  return shape;
}

/// A cone with a closed foot of radius 1 and an open top of radius 0.2, of so many sides. The rim
/// of the top goes up and down a little.
[[nodiscard]] Shape open_cone(std::uint32_t sides) {
  Shape shape;
  for (std::uint32_t i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / sides;
    shape.vertices.emplace_back(std::cos(angle), std::sin(angle), 0);
    shape.vertices.emplace_back(0.2 * std::cos(angle), 0.2 * std::sin(angle),
                                5 + 0.01 * std::sin(5 * angle));
  }
  shape.vertices.push_back(Vector3::Zero());
  for (std::uint32_t i = 0; i < sides; ++i) {
    const std::uint32_t low = 2 * i, high = low + 1, next = 2 * ((i + 1) % sides);
    shape.triangles.push_back({low, next, high});
    shape.triangles.push_back({next, next + 1, high});
    shape.triangles.push_back({2 * sides, next, low});
  }
  return shape;
}

/// A cube with edges of 2 and on its top a bump of 0.2, whose foot is a part of the top as well: at
/// its rim three triangles meet. A half of the bump's own top is missing.
[[nodiscard]] Shape cube_with_pierced_bump() {
  Shape shape{{{-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}}, {}};
  for (const double z : {1.0, 1.2}) {
    for (const auto& [x, y] : {std::pair(-0.1, -0.1), {0.1, -0.1}, {0.1, 0.1}, {-0.1, 0.1}}) {
      shape.vertices.emplace_back(x, y, z);
    }
  }
  for (std::uint32_t k = 0; k < 4; ++k) {
    const std::uint32_t next = (k + 1) % 4;
    for (const std::uint32_t ring : {0U, 4U}) {
      shape.triangles.push_back({ring + k, ring + next, ring + 4 + next});
      shape.triangles.push_back({ring + k, ring + 4 + next, ring + 4 + k});
    }
  }
  for (const auto& triangle : {std::array{4U, 5U, 6U}, {4U, 6U, 7U}, {8U, 9U, 10U}}) {
    shape.triangles.push_back(triangle);
  }
  Shape rest = box({2, 2, 2});
  std::erase_if(rest.triangles, [&](const auto& triangle) {
    return std::all_of(triangle.begin(), triangle.end(),
                       [&](std::uint32_t corner) { return rest.vertices[corner].z() > 0; });
  });
  return merged(shape, rest);
}

}  // namespace

TEST_CASE("Parts that lids close together are turned together") {
  for (const bool inside_out : {false, true}) {
    const Shape shape = cube_with_pierced_bump();
    const Mesh mesh = load_shape(inside_out ? turned(shape) : shape);
    CHECK(mesh.closed());
    CHECK(mesh.lids.size() == 2);
    baker::for_each_edge(baker::sorted_edges(mesh.triangles),
                         [](const auto& users) { CHECK(baker::is_balanced(users)); });
    const baker::WindingNumber winding(mesh.vertices, mesh.triangles);
    CHECK(winding.at({0, 0, 0.9}) == Approx(1));
    CHECK(winding.at({0, 0, 1.3}) == Approx(0).margin(1e-9));
  }
}

TEST_CASE("A small hole of a solid is closed by a lid, and the file's border edges are told") {
  for (const bool inside_out : {false, true}) {
    const Shape shape = holed_sphere({20});
    const Mesh mesh = load_shape(inside_out ? turned(shape) : shape);
    const Shape whole = sphere(1, 4);
    CHECK(mesh.closed());
    REQUIRE(mesh.lids.size() == 1);
    CHECK(mesh.lids[0].edges == mesh.border_edges);
    CHECK((mesh.border_edges == 5 || mesh.border_edges == 6));
    CHECK(mesh.lids[0].area > 0);
    CHECK((mesh.lids[0].middle.normalized() - whole.vertices[20]).norm() < 0.02);
    CHECK(mesh.triangles.size() == shape.triangles.size() + mesh.border_edges - 2);
    CHECK(signed_volume(mesh.vertices, mesh.triangles) ==
          Approx(signed_volume(whole.vertices, whole.triangles)).epsilon(1e-3));
  }
}

TEST_CASE("Holes that meet at a vertex are closed each by a lid of its own") {
  const Shape whole = sphere(1, 4);
  // Two vertices whose fans have one vertex in common and no edge.
  const std::uint32_t first = 100;
  std::vector<std::uint32_t> around;
  const auto neighbours = [&](std::uint32_t vertex) {
    std::vector<std::uint32_t> found;
    for (const auto& triangle : whole.triangles) {
      if (std::find(triangle.begin(), triangle.end(), vertex) == triangle.end()) continue;
      found.insert(found.end(), triangle.begin(), triangle.end());
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  };
  around = neighbours(first);
  std::uint32_t second = 0;
  for (std::uint32_t vertex = 0; vertex < whole.vertices.size() && second == 0; ++vertex) {
    std::vector<std::uint32_t> common;
    const auto other = neighbours(vertex);
    std::set_intersection(around.begin(), around.end(), other.begin(), other.end(),
                          std::back_inserter(common));
    if (common.size() == 1 && vertex != first) second = vertex;
  }
  REQUIRE(second != 0);
  const Mesh mesh = load_shape(holed_sphere({first, second}));
  CHECK(mesh.closed());
  CHECK(mesh.lids.size() == 2);
}

TEST_CASE("A hole of very many edges is closed by a lid that stays within it") {
  const Mesh mesh = load_shape(open_cone(1500));
  CHECK(mesh.closed());
  REQUIRE(mesh.lids.size() == 1);
  CHECK(mesh.lids[0].edges == 1500);
  CHECK(mesh.lids[0].area == Approx(0.04 * std::numbers::pi).epsilon(0.05));
  const double cone = std::numbers::pi * 5 / 3 * (1 + 0.2 + 0.04);
  CHECK(signed_volume(mesh.vertices, mesh.triangles) == Approx(cone).epsilon(1e-3));
}

TEST_CASE("A bowl, a box without a lid and a fin are sheets, and the box of the fin is a solid") {
  Shape bowl = sphere(1, 3);
  std::erase_if(bowl.triangles, [&](const auto& t) { return bowl.vertices[t[0]].z() > 0.6; });
  Shape open = box({1, 1, 1});
  open.triangles.resize(10);
  Shape finned = box({1, 1, 1});
  finned.vertices.emplace_back(1, 1, 1);
  finned.triangles.push_back({3, 7, 8});
  const std::vector<Shape> shapes{bowl, open, finned};
  for (const Shape& shape : shapes) {
    const Mesh mesh = load_shape(shape);
    CHECK_FALSE(mesh.closed());
    CHECK(mesh.lids.empty());
    CHECK(mesh.sheets == 1);
    CHECK(mesh.triangles.size() == shape.triangles.size());
    CHECK(mesh.solid_triangles() == (&shape == &shapes[2] ? 12 : 0));
  }
}

TEST_CASE("Open surfaces are solids or sheets where that is asked for") {
  Shape open = box({1, 1, 1});
  open.triangles.resize(10);
  const Mesh solid = load_shape(open, {.open_as = OpenAs::solid});
  CHECK(solid.closed());
  CHECK(solid.lids.size() == 1);
  CHECK(signed_volume(solid.vertices, solid.triangles) == Approx(1));
  const Mesh sheet = load_shape(holed_sphere({20}), {.open_as = OpenAs::sheet});
  CHECK(sheet.solid_triangles() == 0);
  CHECK(sheet.lids.empty());
}

TEST_CASE("A strip that is one-sided is a sheet") {
  Shape strip;
  constexpr std::uint32_t parts = 12;
  for (std::uint32_t i = 0; i < parts; ++i) {
    const double turn = 2 * std::numbers::pi * i / parts, lean = turn / 2;
    const Vector3 out(std::cos(turn), std::sin(turn), 0);
    const Vector3 across = 0.2 * (std::cos(lean) * Vector3::UnitZ() + std::sin(lean) * out);
    strip.vertices.push_back(out + across);
    strip.vertices.push_back(out - across);
  }
  for (std::uint32_t i = 0; i < parts; ++i) {
    const bool last = i + 1 == parts;
    const std::uint32_t a = 2 * i, b = a + 1, c = last ? 1 : a + 2, d = last ? 0 : a + 3;
    strip.triangles.push_back({a, b, c});
    strip.triangles.push_back({b, d, c});
  }
  const Mesh mesh = load_shape(strip);
  CHECK(mesh.solid_triangles() == 0);
  CHECK(mesh.sheets == 1);
}

TEST_CASE("A leaf that is drawn from both sides, or twice, is one sheet beside a solid") {
  for (const bool other_way : {false, true}) {
    Shape shape = sphere(1, 4);
    const auto first = static_cast<std::uint32_t>(shape.vertices.size());
    for (const Vector3& corner :
         {Vector3(2, 0, 0), Vector3(3, 0, 0), Vector3(3, 1, 0), Vector3(2, 1, 0)}) {
      shape.vertices.push_back(corner);
    }
    const std::size_t solid = shape.triangles.size();
    for (int copy = 0; copy < 2; ++copy) {
      shape.triangles.push_back({first, first + 1, first + 2});
      shape.triangles.push_back({first, first + 2, first + 3});
      for (std::size_t k = 1; other_way && copy > 0 && k <= 2; ++k) {
        std::swap(shape.triangles[shape.triangles.size() - k][1],
                  shape.triangles[shape.triangles.size() - k][2]);
      }
    }
    const Mesh mesh = load_shape(shape);
    CHECK(mesh.sheets == 1);
    CHECK(mesh.sheet_triangles == 2);
    CHECK(mesh.solid_triangles() == solid);
  }
}

TEST_CASE("A part that lies in a plane is a sheet, also where it closes") {
  // A square from both sides, of which each has a diagonal of its own.
  Shape pillow;
  pillow.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 0.8, 0}, {0, 0.8, 0}};
  pillow.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 0, 3}, {1, 3, 2}};
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  for (const Eigen::Matrix3d& way : {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), turn}) {
    for (const OpenAs open_as : {OpenAs::automatic, OpenAs::solid}) {
      Shape shape = pillow;
      for (Vector3& vertex : shape.vertices) vertex = way * vertex;
      Mesh mesh = load_shape(shape, {.open_as = open_as});
      CHECK(mesh.sheets == 1);
      CHECK(mesh.solid_triangles() == 0);
      CHECK(mesh.sheet_triangles == 4);
      shape.triangles.resize(2);
      mesh = load_shape(shape, {.open_as = open_as});
      CHECK(mesh.sheet_triangles == 2);
    }
  }
}

}  // namespace spm::test::mesh_lids_test
