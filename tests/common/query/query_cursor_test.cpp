// SPDX-License-Identifier: Apache-2.0
#include "common/query/query_cursor.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>

#include "common/base/random.hpp"
#include "tests/common/support/mapped_cube.hpp"
#include "tests/support/asset_by_hand.hpp"
#include "tests/support/octree_by_hand.hpp"

namespace spm::query_cursor_test {
namespace {

using test::MappedCube;
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

TEST_CASE("A cursor that goes from map to map answers as single queries do, bit by bit") {
  MappedCube cube(size, {.max_depth = 0.01, .margin = 0.005});
  const std::array<std::uint32_t, 3> maps{
      cube.add_map(4), cube.add_offset_map(4, -0.001F),
      cube.add_map(0, [](const Vector3& at) { return 5 * at.y() * at.y(); })};
  cube.octree.root_words = {test::root_word(OctreeKind::split, 0)};
  cube.octree.words = {2,
                       test::octant_kinds(OctreeKind::map, {{0, OctreeKind::pruned}}),
                       word_of_map(maps[2]),
                       word_of_map(maps[0]),
                       word_of_maps(maps[1], maps[2], {.larger = true, .edge = true}),
                       word_of_maps(maps[0], maps[2], {}),
                       word_of_map(maps[0]),
                       word_of_map(maps[1]),
                       word_of_maps(maps[2], maps[0], {.larger = true})};
  cube.show();
  QueryCursor cursor;
  cursor.begin(&cube.view);
  Random random(6);
  Vector3 place = Vector3::Zero();
  int exact = 0;
  for (int step = 0; step < 8000; ++step) {
    for (int axis = 0; axis < 3; ++axis) {
      place[axis] = std::clamp(place[axis] + random.between(-1e-3, 1e-3), -size / 2, size / 2);
    }
    const Answer answer = query_point(cube.view, place);
    REQUIRE(same_bits(cursor.query(place), answer));
    exact += answer.status == Status::exact ? 1 : 0;
  }
  CHECK(exact > 500);
}

TEST_CASE(
    "Seen from outside its box a surface is told to be no nearer than the field's error allows") {
  MappedCube cube(size);
  // Within the margin of 0.5 mm everywhere on the face at +z.
  cube.fill_with_maps(word_of_map(cube.add_map(4, [](const Vector3&) { return 3e-4; })));
  cube.view.tolerance = 1e-4;
  cube.view.box_low = Vector3::Constant(-size / 2);
  cube.view.box_high = Vector3::Constant(size / 2);
  for (const double off : {0.001, 0.01}) {
    const double told = clearance(cube.view, {0, 0, size / 2 + off});
    CHECK(told == Approx(std::hypot(off, 3e-4 - 1e-4)).epsilon(1e-4));
  }
}

TEST_CASE("A cursor tells by how much the field bends where one map is all of it") {
  MappedCube cube(size);
  // From the face at +z down; level in its middle.
  const std::uint32_t bent = cube.add_map(4, [](const Vector3& at) {
    return 12 * at.x() * at.x() - 4 * at.y() * at.y() + at.x() * at.y();
  });
  const std::uint32_t flat = cube.add_map(4);
  const auto bend = [&](std::uint32_t word, const Vector3& point) {
    cube.fill_with_maps(word);
    QueryCursor cursor;
    cursor.begin(&cube.view);
    REQUIRE(cursor.distance(point).known());
    return cursor.bend();
  };
  const Vector3 middle(0, 0, size / 2), beside(0.004, -0.002, size / 2);
  CHECK(bend(word_of_map(bent), middle) == Approx(16).epsilon(1e-4));
  CHECK(bend(word_of_map(bent), beside) == Approx(bend_on(cube.charts[bent], beside)));
  CHECK(bend(word_of_map(flat), middle) == 0);
  // Which of two maps counts changes within the leaf.
  CHECK(bend(word_of_maps(bent, flat, {}), middle) == 0);
}

TEST_CASE("A cursor tells of no bend where triangles answer") {
  const SparseCubeByHand cube(size);
  QueryCursor cursor;
  cursor.begin(&cube.view);
  REQUIRE(cursor.distance({0.004, -0.002, size / 2}).known());
  CHECK(cursor.bend() == 0);
}

}  // namespace
}  // namespace spm::query_cursor_test
