// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <map>
#include <set>

#include "baker/base/bake_error.hpp"
#include "baker/trees/bvh_build.hpp"
#include "baker/trees/element_choice.hpp"
#include "baker/trees/sign_octree_build.hpp"
#include "baker/trees/triangle_fans.hpp"
#include "common/asset/bvh.hpp"
#include "common/base/random.hpp"
#include "tests/baker/pipeline/bake_support.hpp"

namespace spm::baker::elements_test {
namespace {

Vector3 random_point(std::uint64_t seed, std::uint64_t index) {
  return {random_unit(seed, 3 * index), random_unit(seed, 3 * index + 1),
          random_unit(seed, 3 * index + 2)};
}

/// Small boxes at random places; every third a tile, a few of the others caps.
std::vector<BvhElement> random_elements(std::size_t count) {
  std::vector<BvhElement> elements;
  std::uint32_t tiles = 0, fans = 0;
  for (std::size_t i = 0; i < count; ++i) {
    BvhElement element;
    element.triangles = static_cast<std::uint32_t>(i % 3);
    element.cap = element.triangles > 0 && i % 7 == 1;
    element.number = element.triangles == 0 ? tiles++ : fans++;
    element.box.low = random_point(1, i);
    element.box.high = element.box.low + 0.05 * random_point(2, i);
    elements.push_back(element);
  }
  return elements;
}

double distance_to(const Box& box, const Vector3& point) {
  return (box.low - point).cwiseMax(point - box.high).cwiseMax(0.0).norm();
}

/// Old numbers of the fans by the first of their corners.
std::map<std::uint32_t, std::uint32_t> fans_by_corner(const std::vector<BvhElement>& elements,
                                                      const BuiltBvh& bvh) {
  std::map<std::uint32_t, std::uint32_t> triangles, fans;
  for (const BvhElement& element : elements) {
    if (element.triangles > 0) triangles[element.number] = element.triangles;
  }
  std::uint32_t corner = 0;
  for (const std::uint32_t fan : bvh.fans) {
    fans[corner] = fan;
    corner += triangles[fan] + 2;
  }
  return fans;
}

/// The elements that a visit meets: whether each is a tile, and its old number.
std::set<std::pair<bool, std::uint32_t>> met(const std::vector<BvhElement>& elements,
                                             const BuiltBvh& bvh, const Vector3& point,
                                             double distance) {
  std::set<std::pair<bool, std::uint32_t>> found;
  const auto fans = fans_by_corner(elements, bvh);
  const Bvh view{bvh.data.origin, bvh.data.size, bvh.data.words};
  visit_elements(
      view, point,
      [&](const BvhChild& child) {
        const bool tile = child.kind == ElementKind::tile;
        found.emplace(tile, tile ? bvh.tiles[child.first] : fans.at(child.first));
      },
      [distance] { return distance; });
  return found;
}

TEST_CASE("A tree of elements leads to every element that may be near enough") {
  for (const std::size_t count : {1, 2, 5, 300}) {
    const std::vector<BvhElement> elements = random_elements(count);
    const BuiltBvh bvh = build_bvh(elements);
    for (std::uint64_t i = 0; i < 200; ++i) {
      const Vector3 point = 1.4 * random_point(3, i) - Vector3::Constant(0.2);
      const double distance = 0.3 * random_unit(4, i);
      const auto found = met(elements, bvh, point, distance);
      for (const BvhElement& element : elements) {
        if (distance_to(element.box, point) > distance) continue;
        CHECK(found.count({element.triangles == 0, element.number}) == 1);
      }
    }
  }
}

TEST_CASE("A tree names every element once, and caps last") {
  const std::vector<BvhElement> elements = random_elements(400);
  const BuiltBvh bvh = build_bvh(elements);
  CHECK(std::set(bvh.tiles.begin(), bvh.tiles.end()).size() == bvh.tiles.size());
  CHECK(std::set(bvh.fans.begin(), bvh.fans.end()).size() == bvh.fans.size());
  CHECK(bvh.tiles.size() + bvh.fans.size() == elements.size());
  std::map<std::uint32_t, bool> caps;
  for (const BvhElement& element : elements) {
    if (element.triangles > 0) caps[element.number] = element.cap;
  }
  for (const auto& [corner, fan] : fans_by_corner(elements, bvh)) {
    CHECK(caps[fan] == (corner >= bvh.first_cap));
  }
}

TEST_CASE("Elements that all lie in one place still make a tree that ends") {
  std::vector<BvhElement> elements = random_elements(500);
  for (BvhElement& element : elements) element.box = elements[0].box;
  const BuiltBvh bvh = build_bvh(elements);
  CHECK(met(elements, bvh, elements[0].box.low, 1e-3).size() == elements.size());
}

TEST_CASE("Cubes of one side hold no point of the other, and all of the band is in some cube") {
  const Caster caster(test::surface_of(test::torus(0.02, 0.006, 60, 30)));
  const Band band{0.002, 0.001};
  const SignOctreeBuilder sign_octree(caster, band, 1e-4, nullptr, {});
  for (std::uint64_t i = 0; i < 3000; ++i) {
    const Vector3 point = 0.06 * (random_point(5, i) - Vector3::Constant(0.5));
    const double distance = caster.closest(point).distance;
    const SignKind kind = sign_octree.place(point);
    if (kind == SignKind::inside) CHECK(distance < 0);
    if (kind == SignKind::outside) CHECK(distance > 0);
    if (kind == SignKind::far) CHECK(distance > band.margin);
  }
}

TEST_CASE("Space tells the same in memory and in its words, before and after mending") {
  const Caster caster(test::surface_of(test::box({0.03, 0.02, 0.01})));
  SignOctreeBuilder sign_octree(caster, {0.002, 0.001}, 1e-4, nullptr, {});
  const Vector3 beside(0.0154, 0.0005, 0.0005);
  REQUIRE(sign_octree.place(beside) == SignKind::boundary);
  CHECK(sign_octree.resolve(beside));
  CHECK(sign_octree.place(beside) == SignKind::outside);
  CHECK_FALSE(sign_octree.resolve(beside));
  const SignOctreeData data = sign_octree.data();
  const SignOctree octree{data.origin, data.edge, data.words};
  for (std::uint64_t i = 0; i < 3000; ++i) {
    const Vector3 point = 0.04 * (random_point(6, i) - Vector3::Constant(0.5));
    CHECK(sign_at(octree, point) == sign_octree.place(point));
  }
}

/// Turns fans back into triangles.
std::vector<std::array<Vector3, 3>> opened(const std::vector<TriangleFan>& fans) {
  std::vector<std::array<Vector3, 3>> triangles;
  for (const TriangleFan& fan : fans) {
    for (std::size_t k = 2; k < fan.size(); ++k) triangles.push_back({fan[0], fan[k - 1], fan[k]});
  }
  return triangles;
}

TEST_CASE("Fans hold every triangle once, wound as it was") {
  for (const test::Shape& shape : {test::sphere(1, 2), test::box({1, 2, 3})}) {
    std::vector<std::array<Vector3, 3>> triangles;
    for (const auto& [a, b, c] : shape.triangles) {
      triangles.push_back({shape.vertices[a], shape.vertices[b], shape.vertices[c]});
    }
    triangles.push_back(triangles[3]);  // and one twice
    const std::vector<TriangleFan> fans = fans_of(triangles);
    const auto key = [](const std::array<Vector3, 3>& triangle) {
      std::array<std::array<double, 3>, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) {
        corners[k] = {triangle[k].x(), triangle[k].y(), triangle[k].z()};
      }
      std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
      return corners;
    };
    std::multiset<std::array<std::array<double, 3>, 3>> wanted, found;
    for (const auto& triangle : triangles) wanted.insert(key(triangle));
    for (const auto& triangle : opened(fans)) found.insert(key(triangle));
    CHECK(found == wanted);
    CHECK(fans.size() < triangles.size() / 2);
  }
}

TEST_CASE("Triangles that share no edge are fans of their own") {
  const std::array<Vector3, 3> one{Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0, 1, 0)};
  const std::array<Vector3, 3> corner{Vector3(0, 0, 0), Vector3(-1, 0, 0), Vector3(0, -1, 0)};
  const std::array<Vector3, 3> turned{Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0, 0, 1)};
  CHECK(fans_of({one, corner}).size() == 2);
  CHECK(fans_of({one, turned}).size() == 2);
  CHECK(fans_of({}).empty());
}

/// A surface of this many equal squares in a row, two triangles each, and tiles over them: tile k
/// stands for square k, the last square for nothing.
struct Row {
  test::Shape shape;
  std::vector<TileData> tiles;
  SurfaceCover cover;

  explicit Row(std::uint32_t squares) {
    for (std::uint32_t k = 0; k <= squares; ++k) {
      shape.vertices.emplace_back(0.001 * k, 0, 0);
      shape.vertices.emplace_back(0.001 * k, 0.001, 0);
    }
    for (std::uint32_t k = 0; k < squares; ++k) {
      shape.triangles.push_back({2 * k, 2 * k + 2, 2 * k + 1});
      shape.triangles.push_back({2 * k + 1, 2 * k + 2, 2 * k + 3});
    }
    cover.uses.resize(shape.triangles.size());
    cover.open.resize(shape.triangles.size());
    tiles.resize(squares);
    for (std::uint32_t k = 0; k < squares; ++k) {
      tiles[k].valid = ~std::uint64_t{0};
      for (const std::uint32_t t : {2 * k, 2 * k + 1}) cover.uses[t] = {{k, 1}};
    }
  }
};

TEST_CASE("Tiles that stand for few triangles go, until triangles are as much as is free") {
  const Row row(100);
  const Caster caster(test::surface_of(row.shape));
  const ElementChoice choice = choose_elements(caster, row.tiles, row.cover, 0.16);
  CHECK(choice.triangle_area_share == Approx(0.16));
  CHECK(choice.tiles.size() == 84);
  CHECK(choice.triangles.size() == 32);
}

TEST_CASE("A tile stays where its triangles would take more bytes") {
  Row row(100);
  // All triangles rest on one tile.
  for (auto& uses : row.cover.uses) uses = {{0, 1}};
  const Caster caster(test::surface_of(row.shape));
  const ElementChoice choice = choose_elements(caster, row.tiles, row.cover, 0.16);
  CHECK(choice.tiles.size() == 1);
  CHECK(choice.triangles.empty());
}

TEST_CASE("Many open pieces of a small triangle become the triangle, few of a large one stay") {
  Row row(100);
  const Caster caster(test::surface_of(row.shape));
  for (auto& uses : row.cover.uses) uses = {{0, 1}};
  const std::array<Vector3, 3> corners{Vector3(0, 0, 0), Vector3(1e-5, 0, 0), Vector3(0, 1e-5, 0)};
  row.cover.open[4].assign(9, {corners, 4});
  row.cover.open[8].assign(1, {corners, 8});
  const ElementChoice choice = choose_elements(caster, row.tiles, row.cover, 0.16);
  REQUIRE(choice.triangles.size() == 2);
  CHECK(choice.triangles[0].corners[1].x() == Approx(0.003));
  CHECK(choice.triangles[1].corners[1].x() == Approx(1e-5));
}

}  // namespace
}  // namespace spm::baker::elements_test
