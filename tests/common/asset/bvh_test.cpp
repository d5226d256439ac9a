// SPDX-License-Identifier: Apache-2.0
#include "common/asset/bvh.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/support/tree_by_hand.hpp"

namespace spm::bvh_test {
namespace {

using test::add_bvh_node;
using test::BoxedChild;
using test::fan_child;
using test::node_child;
using test::tile_child;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A tree over the box from (1, 2, 3), each edge 255 long, so that a byte of a box is a metre.
Bvh tree_of(const std::vector<std::uint32_t>& words) {
  return {Vector3(1, 2, 3), {255, 255, 255}, words};
}

Vector3 at(double x, double y, double z) { return Vector3(1, 2, 3) + Vector3(x, y, z); }

/// A tile whose box is the slab from `low` to `high` along x.
BoxedChild slab(std::uint32_t tile, std::uint8_t low, std::uint8_t high) {
  BoxedChild child = tile_child(tile);
  child.low[0] = low;
  child.high[0] = high;
  return child;
}

/// Numbers of the leaves in the order of visits; the limit stays the same.
std::vector<std::uint32_t> visited(const std::vector<std::uint32_t>& words, const Vector3& point,
                                   double limit = infinity) {
  std::vector<std::uint32_t> order;
  visit_elements(
      tree_of(words), point, [&order](const BvhChild& child) { order.push_back(child.first); },
      [limit] { return limit; });
  return order;
}

TEST_CASE("A child's word holds its kind, its number and its triangles") {
  for (const BvhChild& child :
       {BvhChild{ElementKind::node, 7, 1}, BvhChild{ElementKind::tile, max_bvh_elements - 1, 1},
        BvhChild{ElementKind::fan, 1234567, max_fan_triangles}}) {
    const BvhChild read = unpack_child(pack_child(child));
    CHECK(read.kind == child.kind);
    CHECK(read.first == child.first);
    CHECK(read.count == child.count);
  }
  CHECK(unpack_child(0).kind == ElementKind::none);
}

TEST_CASE("A child's box is its bytes in 255ths of the node's") {
  std::vector<std::uint32_t> words;
  BoxedChild child = tile_child(0);
  child.low = {0, 51, 102};
  child.high = {255, 102, 204};
  add_bvh_node(words, {tile_child(0), tile_child(0), child});
  const BvhBox node{{10, 20, 30}, {15, 30, 40}};
  const BvhBox box = child_box(node, words.data(), 2);
  CHECK(box.low[0] == Approx(10));
  CHECK(box.high[0] == Approx(15));
  CHECK(box.low[1] == Approx(22));
  CHECK(box.high[1] == Approx(24));
  CHECK(box.low[2] == Approx(34));
  CHECK(box.high[2] == Approx(38));
  NodeBoxes boxes;
  find_node_boxes(node, words.data(), {12, 23, 35}, boxes);
  CHECK(boxes.squares[2] == 0);
  find_node_boxes(node, words.data(), {18, 26, 35}, boxes);
  CHECK(boxes.squares[2] == Approx(9 + 4));
}

TEST_CASE("The boxes of all children at once are theirs one by one, and as far from a place") {
  const std::uint64_t seed = GENERATE(range(0, 20));
  std::mt19937_64 random(seed);
  std::vector<std::uint32_t> words(bvh_node_words);
  for (std::uint32_t& word : words) word = static_cast<std::uint32_t>(random());
  const BvhBox node{{10, 20, 30}, {15, 30, 40}};
  const auto number = [&](float low, float high) {
    return low + (high - low) * static_cast<float>(random() % 1000) / 1000;
  };
  const std::array<float, 3> place{number(5, 20), number(15, 35), number(25, 45)};
  NodeBoxes boxes;
  find_node_boxes(node, words.data(), place, boxes);
  for (std::size_t k = 0; k < bvh_children; ++k) {
    const BvhBox box = child_box(node, words.data(), k);
    CHECK(boxes.box(k).low == box.low);
    CHECK(boxes.box(k).high == box.high);
    double square = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      // A box of random bytes may be turned inside out: then the farther of the two counts.
      const float off = std::max({box.low[axis] - place[axis], place[axis] - box.high[axis], 0.0F});
      square += double{off} * double{off};
    }
    CHECK(boxes.squares[k] == Approx(square));
  }
}

TEST_CASE("A place that is no number lies 0 from every box") {
  std::vector<std::uint32_t> words;
  add_bvh_node(words, {slab(0, 100, 110), slab(1, 200, 210)});
  NodeBoxes boxes;
  const float none = std::numeric_limits<float>::quiet_NaN();
  find_node_boxes({{0, 0, 0}, {1, 1, 1}}, words.data(), {none, none, none}, boxes);
  CHECK(boxes.squares == NodeBoxes::Lanes{0, 0, 0, 0});
}

TEST_CASE("All leaves within the limit are visited, the nearest box first") {
  std::vector<std::uint32_t> words;
  add_bvh_node(words, {slab(0, 100, 110), slab(1, 200, 210), slab(2, 0, 10), slab(3, 50, 60)});
  using Order = std::vector<std::uint32_t>;
  CHECK(visited(words, at(0, 100, 100)) == Order{2, 3, 0, 1});
  CHECK(visited(words, at(255, 100, 100)) == Order{1, 0, 3, 2});
  CHECK(visited(words, at(255, 100, 100), 150) == Order{1, 0});
  CHECK(visited(words, at(0, 100, 100), 55) == Order{2, 3});
  // From outside the box, off to its side.
  CHECK(visited(words, at(-40, -30, 100), 60) == Order{2});
  CHECK(visited(words, at(-40, -30, 100), 49) == Order{});
}

TEST_CASE("Leaves below several nodes are visited with their kinds and counts") {
  std::vector<std::uint32_t> words;
  BoxedChild right = node_child(2);
  right.low[0] = 128;
  add_bvh_node(words, {right, node_child(1)});
  add_bvh_node(words, {tile_child(5), fan_child(9, 64)});
  add_bvh_node(words, {fan_child(3, 2)});
  std::vector<BvhChild> leaves;
  visit_elements(
      tree_of(words), at(0, 0, 0), [&leaves](const BvhChild& child) { leaves.push_back(child); },
      [] { return infinity; });
  REQUIRE(leaves.size() == 3);
  const auto is = [](const BvhChild& child, ElementKind kind, std::uint32_t first,
                     std::uint32_t count) {
    return child.kind == kind && child.first == first && child.count == count;
  };
  CHECK(std::count_if(leaves.begin(), leaves.end(), [&is](const BvhChild& child) {
          return is(child, ElementKind::tile, 5, 1) || is(child, ElementKind::fan, 9, 64);
        }) == 2);
  // The right half is farther, and so its leaf is the last.
  CHECK(is(leaves.back(), ElementKind::fan, 3, 2));
}

TEST_CASE("A limit that shrinks to the nearest leaf finds it among many, and few are visited") {
  // Cubes of one metre at random places, below four times four nodes with whole boxes.
  std::mt19937_64 bits(5);
  const auto byte = [&bits] { return static_cast<std::uint8_t>(bits() % 255); };
  std::vector<std::array<std::uint8_t, 3>> corners(64);
  for (auto& corner : corners) corner = {byte(), byte(), byte()};
  std::sort(corners.begin(), corners.end());
  std::vector<std::uint32_t> words;
  add_bvh_node(words, {node_child(1), node_child(2), node_child(3), node_child(4)});
  for (std::uint32_t k = 0; k < 4; ++k) {
    add_bvh_node(words, {node_child(5 + 4 * k), node_child(6 + 4 * k), node_child(7 + 4 * k),
                         node_child(8 + 4 * k)});
  }
  for (std::uint32_t k = 0; k < 64; k += 4) {
    std::vector<BoxedChild> children;
    for (std::uint32_t leaf = k; leaf < k + 4; ++leaf) {
      BoxedChild child = tile_child(leaf);
      child.low = child.high = corners[leaf];
      for (std::uint8_t& high : child.high) ++high;
      children.push_back(child);
    }
    add_bvh_node(words, children);
  }
  // Distance from the middle of a leaf's cube, which is at least that of the cube.
  const auto distance = [&corners](std::uint32_t leaf, const Vector3& point) {
    const auto& corner = corners[leaf];
    return (point - at(corner[0] + 0.5, corner[1] + 0.5, corner[2] + 0.5)).norm();
  };
  std::size_t visits = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Vector3 point = at(byte() + 0.3, byte() + 0.3, byte() + 0.3);
    double nearest = infinity, wanted = infinity;
    visit_elements(
        tree_of(words), point,
        [&](const BvhChild& child) {
          nearest = std::min(nearest, distance(child.first, point));
          ++visits;
        },
        [&nearest] { return nearest; });
    for (std::uint32_t leaf = 0; leaf < 64; ++leaf) {
      wanted = std::min(wanted, distance(leaf, point));
    }
    CHECK(nearest == wanted);
  }
  CHECK(visits < 200 * 64 / 2);
}

TEST_CASE("A tree without nodes has no leaves, and one cut short no half node") {
  CHECK(visited({}, at(0, 0, 0)).empty());
  std::vector<std::uint32_t> words;
  add_bvh_node(words, {tile_child(1), node_child(1)});
  add_bvh_node(words, {tile_child(2)});
  CHECK(visited(words, at(0, 0, 0)).size() == 2);
  words.pop_back();
  CHECK(visited(words, at(0, 0, 0)) == std::vector<std::uint32_t>{1});
  words.resize(bvh_node_words - 1);
  CHECK(visited(words, at(0, 0, 0)).empty());
}

TEST_CASE("Words that lead in circles, or outside, end") {
  std::vector<std::uint32_t> itself;
  add_bvh_node(itself, {node_child(0), node_child(0), node_child(0), tile_child(1)});
  CHECK(visited(itself, at(9, 9, 9)).size() <= bvh_children);
  std::vector<std::uint32_t> circle;
  add_bvh_node(circle, {node_child(1), node_child(1), tile_child(1)});
  add_bvh_node(circle, {node_child(0), node_child(2), tile_child(2)});
  add_bvh_node(circle, {node_child(1), node_child(0xFFFFFF), node_child(3), tile_child(3)});
  CHECK(visited(circle, at(9, 9, 9)).size() <= 3 * bvh_children);
}

TEST_CASE("A tree deeper than it may be ends, and what fits is visited") {
  // Each node has one leaf and three links to the next node: more than may wait at a time.
  std::vector<std::uint32_t> words;
  constexpr std::uint32_t deep = 4 * bvh_levels;
  for (std::uint32_t node = 0; node < deep; ++node) {
    add_bvh_node(words, {tile_child(node), node_child(node + 1), node_child(node + 1),
                         node_child(node + 1)});
  }
  const std::vector<std::uint32_t> order = visited(words, at(9, 9, 9));
  CHECK(order.size() >= static_cast<std::size_t>(bvh_levels));
  CHECK(order.size() <= deep * bvh_children);
}

TEST_CASE("Points that are no numbers and random words visit no leaf too often") {
  std::mt19937_64 bits(6);
  std::vector<std::uint32_t> words(12 * bvh_node_words);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int trial = 0; trial < 2000; ++trial) {
    for (std::size_t k = 0; k < words.size(); ++k) {
      words[k] = static_cast<std::uint32_t>(bits());
      if (k % bvh_node_words < bvh_children && bits() % 2 == 0) {
        words[k] = pack_child({ElementKind::node, static_cast<std::uint32_t>(bits() % 12), 1});
      }
    }
    for (const Vector3& point : {at(1, 2, 3), Vector3(nan, 0, 0), Vector3(infinity, 0, 0)}) {
      CHECK(visited(words, point, trial % 2 == 0 ? infinity : 10).size() <= 12 * bvh_children);
    }
  }
}

}  // namespace
}  // namespace spm::bvh_test
