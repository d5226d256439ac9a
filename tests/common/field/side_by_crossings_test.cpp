// SPDX-License-Identifier: Apache-2.0
#include "common/field/side_by_crossings.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "common/base/random.hpp"
#include "tests/support/octree_by_hand.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/triangle_octree.hpp"

namespace spm::side_by_crossings_test {
namespace {

constexpr double step = 1e-6;
constexpr double edge = 0.05;

/// A shape in one cube of space about the origin, in a list that knows a corner of the cube.
class Listed {
 public:
  explicit Listed(const test::Shape& shape)
      : octree_(test::triangle_octree(shape, {Vector3::Constant(-edge / 2), edge}, step)) {
    mesh = {.origin = octree_.lattice_origin,
            .step = octree_.lattice_step,
            .corners = octree_.corners,
            .triangles = octree_.triangles,
            .sides = octree_.sides};
    DistanceOctree view;
    view.words = octree_.words;
    view.lists = octree_.lists;
    list = list_of(view, octree_.words.data());
  }
  Listed(const Listed&) = delete;
  Listed& operator=(const Listed&) = delete;

  IndexedTriangles mesh;
  TriangleList list;

  [[nodiscard]] std::optional<bool> inside(const Vector3& point) const {
    return side_by_crossings(mesh, list, Vector3::Zero(), edge / 2, point, edge);
  }

 private:
  OctreeData octree_;
};

Vector3 random_place(std::uint64_t k, double size) {
  return size * Vector3(random_unit(7, 3 * k) - 0.5, random_unit(7, 3 * k + 1) - 0.5,
                        random_unit(7, 3 * k + 2) - 0.5);
}

double box_distance(const Vector3& point, double size) {
  const Vector3 off = point.cwiseAbs() - Vector3::Constant(size / 2);
  return off.maxCoeff() < 0 ? off.maxCoeff() : off.cwiseMax(0).norm();
}

}  // namespace

TEST_CASE("Crossings tell inside from outside of a box, from every known place of the cube") {
  const test::Shape box = test::on_lattice(test::box({0.02, 0.02, 0.02}), step);
  Listed listed(box);
  REQUIRE(listed.list.known);
  for (std::uint32_t known = 0; known < places_of_cube; ++known) {
    listed.list.known = KnownPlace{known, known == 8};
    for (std::uint64_t k = 0; k < 500; ++k) {
      const Vector3 point = random_place(k, edge);
      CHECK(listed.inside(point) == (box_distance(point, 0.02) < 0));
    }
  }
}

TEST_CASE("A way through a corner or along a side gives way to another one") {
  const Listed listed(test::on_lattice(test::box({0.02, 0.02, 0.02}), step));
  // The known corner, a corner of the box and the middle lie on one line.
  CHECK(listed.inside(Vector3::Zero()) == true);
  CHECK(listed.inside(Vector3::Constant(0.009)) == true);
  CHECK(listed.inside(Vector3::Constant(0.011)) == false);
  CHECK(listed.inside(Vector3::Constant(-0.0101)) == false);
  // In the plane of the known corner and two sides of the box.
  CHECK(listed.inside({0.005, 0.005, 0.02}) == false);
  CHECK(listed.inside({0.005, 0.005, 0.0}) == true);
}

TEST_CASE("Crossings count folded slivers and walls that lie on each other as nothing") {
  test::Shape shape = test::on_lattice(test::box({0.02, 0.02, 0.02}), step);
  // A sheet without thickness that cuts the box and its surroundings, and hairs one step high.
  const auto first = static_cast<std::uint32_t>(shape.vertices.size());
  for (const Vector3& corner : {Vector3(-0.02, -0.02, 0.003), Vector3(0.02, -0.02, 0.003),
                                Vector3(0, 0.02, 0.003), Vector3(0.012, -0.02, 0.012),
                                Vector3(0.012, 0.02, 0.012), Vector3(0.012, 0.0, 0.012 + step)}) {
    shape.vertices.push_back(corner);
  }
  for (const std::uint32_t corner : {first, first + 3}) {
    shape.triangles.push_back({corner, corner + 1, corner + 2});
    shape.triangles.push_back({corner, corner + 2, corner + 1});
  }
  const Listed listed(shape);
  for (std::uint64_t k = 0; k < 2000; ++k) {
    const Vector3 point = random_place(k, edge);
    CHECK(listed.inside(point) == (box_distance(point, 0.02) < 0));
  }
}

TEST_CASE("In a cavity crossings tell outside, and within two solids at once inside") {
  const test::Shape box = test::box({0.03, 0.03, 0.03});
  const Listed hollow(test::merged(box, test::turned_inside_out(test::box({0.02, 0.02, 0.02}))));
  const Listed twice(test::merged(box, test::box({0.02, 0.02, 0.02})));
  for (std::uint64_t k = 0; k < 1000; ++k) {
    const Vector3 point = random_place(k, edge);
    const bool outer = box_distance(point, 0.03) < 0, inner = box_distance(point, 0.02) < 0;
    CHECK(hollow.inside(point) == (outer && !inner));
    CHECK(twice.inside(point) == outer);
  }
}

TEST_CASE("Without a known place or without triangles crossings tell nothing") {
  Listed listed(test::box({0.02, 0.02, 0.02}));
  listed.list.known.reset();
  CHECK_FALSE(listed.inside(Vector3::Zero()));
  listed.list.known = KnownPlace{};
  // Words of a damaged file lead nowhere else.
  listed.mesh.triangles = listed.mesh.triangles.first(4);
  CHECK_NOTHROW(listed.inside(Vector3::Zero()));
  listed.mesh.triangles = {};
  CHECK_FALSE(listed.inside(Vector3::Zero()));
}

}  // namespace spm::side_by_crossings_test
