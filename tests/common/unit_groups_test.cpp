// SPDX-License-Identifier: Apache-2.0
#include "common/unit_groups.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "common/closest_on_triangle.hpp"
#include "common/oriented_box.hpp"
#include "every_target.hpp"
#include "random.hpp"

namespace spm {
namespace {

using test::Random;

Vector3 vector_in(Random& random, double reach) {
  return {random.between(-reach, reach), random.between(-reach, reach),
          random.between(-reach, reach)};
}

std::array<float, 3> floats(const Vector3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

void put(std::array<GroupLanes, 3>& to, std::size_t lane, const Vector3& v) {
  for (std::size_t axis = 0; axis < 3; ++axis) to[axis][lane] = floats(v)[axis];
}

/// Triangles, some of them slivers and points, and where their corners are.
TriangleGroup random_triangles(Random& random, std::vector<std::array<Vector3, 3>>& corners) {
  TriangleGroup group;
  corners.clear();
  for (std::size_t lane = 0; lane < group_units; ++lane) {
    const Vector3 a = vector_in(random, 0.01), side = vector_in(random, 0.003);
    const double thin = lane % 4 == 3 ? 1e-5 : 1;
    const Vector3 other =
        lane == 6 ? side : side * random.between(0, 1) + thin * vector_in(random, 0.003);
    put(group.corner, lane, a);
    put(group.side, lane, side);
    put(group.other, lane, other);
    corners.push_back({a, a + side, a + other});
  }
  return group;
}

BoxGroup random_boxes(Random& random, std::vector<OrientedBox>& boxes) {
  BoxGroup group;
  boxes.clear();
  for (std::size_t lane = 0; lane < group_units; ++lane) {
    OrientedBox box;
    box.middle = vector_in(random, 0.01);
    const Vector3 z = vector_in(random, 1).normalized(), x = z.unitOrthogonal();
    box.axes << x, z.cross(x), z;
    box.half = vector_in(random, 0.002).cwiseAbs();
    for (int axis = 0; axis < 3; ++axis) {
      put(group.axes[static_cast<std::size_t>(axis)], lane, box.axes.col(axis));
    }
    put(group.offset, lane, -(box.axes.transpose() * box.middle));
    put(group.half, lane, box.half);
    boxes.push_back(box);
  }
  return group;
}

struct alignas(64) Squares {
  std::array<float, 3 * group_units> values{};
};

TEST_CASE("The bounds of a group's triangles are their distances, and never more") {
  Random random(1);
  int close = 0, all = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::vector<std::array<Vector3, 3>> corners;
    const std::vector<TriangleGroup> groups{random_triangles(random, corners)};
    const Vector3 place = vector_in(random, 0.012);
    const std::uint32_t number = 0;
    Squares squares;
    const std::uint32_t first =
        group_squares({}, groups, {&number, 1}, floats(place), squares.values.data());
    for (std::size_t lane = 0; lane < group_units; ++lane) {
      const auto& [a, b, c] = corners[lane];
      const double exact = (place - closest_on_triangle(place, a, b, c)).norm();
      const double bound = std::sqrt(static_cast<double>(squares.values[lane]));
      CHECK(bound <= exact + 1e-7);
      CHECK(squares.values[lane] >= squares.values[first]);
      ++all;
      close += bound > 0.98 * exact ? 1 : 0;
    }
  }
  CHECK(close > all * 0.97);
}

TEST_CASE("The bounds of a group's boxes are the distances of the boxes") {
  Random random(2);
  for (int trial = 0; trial < 500; ++trial) {
    std::vector<OrientedBox> boxes;
    const std::vector<BoxGroup> groups{random_boxes(random, boxes)};
    const Vector3 place = vector_in(random, 0.012);
    const std::uint32_t number = 0;
    Squares squares;
    const std::uint32_t first =
        group_squares(groups, {}, {&number, 1}, floats(place), squares.values.data());
    for (std::size_t lane = 0; lane < group_units; ++lane) {
      const double exact = (place - boxes[lane].closest(place)).norm();
      CHECK(std::sqrt(double{squares.values[lane]}) == Approx(exact).margin(1e-7));
      CHECK(squares.values[lane] >= squares.values[first]);
    }
  }
}

TEST_CASE("Every processor finds the same bounds of groups, bit by bit, and lists the same") {
  Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<OrientedBox> boxes;
    std::vector<std::array<Vector3, 3>> corners;
    const std::vector<BoxGroup> box_groups{random_boxes(random, boxes)};
    std::vector<TriangleGroup> triangles{random_triangles(random, corners)};
    // Alike, so that the least is there twice.
    triangles.push_back(triangles.front());
    const std::array<std::uint32_t, 3> numbers{2, 0, 1};
    const std::array<float, 3> place = floats(vector_in(random, 0.012));
    const auto farthest = static_cast<float>(random.between(0, 1e-4));
    std::vector<std::array<float, 3 * group_units>> found;
    std::vector<std::uint32_t> firsts;
    std::vector<std::vector<std::uint32_t>> lists;
    test::on_every_target([&] {
      Squares squares;
      std::array<std::uint32_t, 4 * group_units> near{};
      firsts.push_back(group_squares(box_groups, triangles, numbers, place, squares.values.data()));
      const std::size_t count =
          near_lanes(squares.values.data(), squares.values.size(), farthest, near.data());
      found.push_back(squares.values);
      lists.emplace_back(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count));
    });
    REQUIRE(!found.empty());
    std::vector<std::uint32_t> wanted;
    for (std::uint32_t k = 0; k < found.front().size(); ++k) {
      if (found.front()[k] <= farthest) wanted.push_back(k);
    }
    for (std::size_t k = 0; k < found.size(); ++k) {
      CHECK(found[k] == found.front());
      CHECK(firsts[k] == firsts.front());
      CHECK(lists[k] == wanted);
    }
  }
}

TEST_CASE("Lanes without a unit, and numbers of no group, are out of all reach") {
  std::vector<BoxGroup> boxes(1);
  boxes.front().offset[0].fill(empty_lane);
  std::vector<TriangleGroup> triangles(1);
  triangles.front().corner[0].fill(empty_lane);
  const std::array<std::uint32_t, 3> numbers{0, 1, 7};
  Squares squares;
  static_cast<void>(group_squares(boxes, triangles, numbers, {0.01F, 0, 0}, squares.values.data()));
  for (const float square : squares.values) CHECK(square > 0.9F * empty_square);
}

}  // namespace
}  // namespace spm
