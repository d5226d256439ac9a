// SPDX-License-Identifier: Apache-2.0
#include "common/query/query_cursor.hpp"

#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <vector>

#include "common/base/random.hpp"
#include "tests/support/asset_by_hand.hpp"
#include "tests/support/octree_by_hand.hpp"

namespace spm::query_cursor_test {
namespace {

using test::SparseCubeByHand;

constexpr double size = 0.04;

bool same_bits(const Answer& a, const Answer& b) {
  const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
  return bits(a.distance) == bits(b.distance) && a.normal == b.normal && a.plane == b.plane &&
         a.source == b.source && a.status == b.status;
}

TEST_CASE("A cursor that follows a walk answers as single queries do, bit by bit") {
  const SparseCubeByHand cube(size);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Random random(seed);
    QueryCursor cursor;
    cursor.begin(&cube.view);
    Vector3 place(size / 2, 0, 0);
    for (int step = 0; step < 4000; ++step) {
      for (int axis = 0; axis < 3; ++axis) place[axis] += random.between(-3e-4, 3e-4);
      if (step % 500 == 499) place = Vector3(0, random.between(-size, size), size / 2);
      REQUIRE(same_bits(cursor.query(place), query_point(cube.view, place)));
    }
    CHECK(cursor.query({std::nan(""), 0, 0}).status == Status::far);
    CHECK(same_bits(cursor.query(place), query_point(cube.view, place)));
  }
}

TEST_CASE("Distances without normals, and normals once they are asked for, are those of queries") {
  const SparseCubeByHand cube(size);
  Random random(3);
  QueryCursor cursor;
  cursor.begin(&cube.view);
  int near = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    const Vector3 place(random.between(-0.6, 0.6) * size, random.between(-0.6, 0.6) * size,
                        random.between(-0.6, 0.6) * size);
    const Answer answer = query_point(cube.view, place);
    const QueriedDistance found = cursor.distance(place);
    REQUIRE(found.status == answer.status);
    if (!found.known()) {
      REQUIRE(std::isnan(found.distance));
      continue;
    }
    REQUIRE(found.distance == answer.distance);
    REQUIRE(cursor.normal() == answer.normal);
    ++near;
  }
  CHECK(near > 500);
}

TEST_CASE("A cursor tells how far the surface is at the least as single places do") {
  SparseCubeByHand cube(size);
  cube.octree.origin = Vector3::Constant(-size);
  cube.octree.edge = 2 * size;
  cube.replace_triangles(test::box(Vector3::Constant(size)));
  cube.octree.beyond_share = 0.5;
  cube.refresh();
  QueryCursor cursor;
  cursor.begin(&cube.view);
  Random random(4);
  int beyond = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Vector3 place(random.between(-1, 1) * size, random.between(-1, 1) * size,
                        random.between(-1, 1) * size);
    static_cast<void>(cursor.distance(place));
    REQUIRE(cursor.clearance(place) == clearance(cube.view, place));
    beyond += cursor.clearance(place) > cube.view.band.margin ? 1 : 0;
  }
  CHECK(beyond > 100);
}

TEST_CASE(
    "Seen from outside its box a surface is told to be no nearer than the field's error allows") {
  SparseCubeByHand cube(size);
  cube.octree.value_unit = 1e-6;
  const double cube_half = cube.octree.edge / 2;
  LocalMap map;
  map.value = 3e-4 / cube_half;  // within the margin of 0.5 mm, everywhere
  map.plane = 1;
  PackedLocalMap packed;
  REQUIRE(pack_local_map(map, cube.octree.value_unit / cube_half, packed));
  cube.octree.root_words = {test::root_word(OctreeKind::polynomial, 0)};
  cube.octree.words = {packed.words.begin(), packed.words.end()};
  cube.refresh();
  cube.view.tolerance = 1e-4;
  cube.view.box_low = Vector3::Constant(-size / 2);
  cube.view.box_high = Vector3::Constant(size / 2);
  for (const double off : {0.001, 0.01}) {
    const double told = clearance(cube.view, {0, 0, size / 2 + off});
    CHECK(told == Approx(std::hypot(off, 3e-4 - 1e-4)).epsilon(1e-4));
  }
}

TEST_CASE("The quadric about a point is the field as far as it is told to reach") {
  SparseCubeByHand cube(size);
  cube.octree.value_unit = 1e-6;
  const double cube_half = cube.octree.edge / 2;
  LocalMap map;
  map.value = 0.1;
  map.slope = {0.2, -0.1, -0.97};
  map.bend = {0.02, -0.01, 0.015, 0.01, -0.02, 0.005};
  map.plane = 1;
  PackedLocalMap packed;
  REQUIRE(pack_local_map(map, cube.octree.value_unit / cube_half, packed));
  cube.octree.root_words = {test::root_word(OctreeKind::polynomial, 0)};
  cube.octree.words = {packed.words.begin(), packed.words.end()};
  cube.refresh();
  cube.view.band = {1, 1};
  QueryCursor cursor;
  cursor.begin(&cube.view);
  const Vector3 point(0.004, -0.002, 0.003);
  const Answer answer = cursor.query(point);
  REQUIRE(answer.status == Status::exact);
  CHECK(cursor.is_quadric(point, 0.001));
  CHECK_FALSE(cursor.is_quadric(point, 2 * cube_half));
  const LocalQuadric field = cursor.quadric(point);
  CHECK(field.distance == Approx(answer.distance).epsilon(1e-12));
  CHECK((field.slope.normalized() - answer.normal).norm() < 1e-12);
  Random random(7);
  for (int trial = 0; trial < 100; ++trial) {
    const Vector3 off(random.between(-1e-3, 1e-3), random.between(-1e-3, 1e-3),
                      random.between(-1e-3, 1e-3));
    const Answer there = query_point(cube.view, point + off);
    const double told = field.distance + field.slope.dot(off) + off.dot(field.bend * off);
    REQUIRE(there.distance == Approx(told).margin(1e-13));
    REQUIRE((there.normal - (field.slope + 2 * field.bend * off).normalized()).norm() < 1e-9);
  }
}

TEST_CASE("A cursor tells by how much the field bends where one polynomial is all of it") {
  SparseCubeByHand cube(size);
  cube.octree.value_unit = 1e-6;
  LocalMap map;
  map.slope = {0, 0, -1};
  map.bend = {0.02, -0.01, 0.015, 0.01, -0.02, 0.005};
  map.plane = 1;
  PackedLocalMap packed;
  REQUIRE(pack_local_map(map, 2 * cube.octree.value_unit / cube.octree.edge, packed));
  const auto of_kind = [&](OctreeKind kind, std::size_t maps) {
    cube.octree.root_words = {test::root_word(kind, 0)};
    cube.octree.words.clear();
    if (kind != OctreeKind::polynomial) cube.octree.words = {1};
    for (std::size_t i = 0; i < maps; ++i) {
      cube.octree.words.insert(cube.octree.words.end(), packed.words.begin(), packed.words.end());
    }
    cube.refresh();
    cube.view.band = {1, 1};
    QueryCursor cursor;
    cursor.begin(&cube.view);
    REQUIRE(cursor.distance({0.004, -0.002, 0.003}).known());
    return cursor;
  };
  const QueryCursor one = of_kind(OctreeKind::polynomial, 1);
  const double trace = one.quadric({0.004, -0.002, 0.003}).bend.trace();
  CHECK(std::abs(trace) > 0.1);
  CHECK(one.bend() == Approx(trace).epsilon(1e-12));
  // Which of two maps counts changes within the leaf.
  CHECK(of_kind(OctreeKind::least, 2).bend() == 0);
}

}  // namespace
}  // namespace spm::query_cursor_test
