// SPDX-License-Identifier: Apache-2.0
#include "common/asset/space_tree.hpp"

#include <catch2/catch.hpp>
#include <limits>
#include <random>
#include <vector>

#include "tests/support/tree_by_hand.hpp"

namespace spm {
namespace {

using test::octants;
using test::space_chain;

/// A tree over the cube from (-1, -1, -1) to (1, 1, 1).
SpaceTree tree_of(const std::vector<std::uint32_t>& words) {
  return {Vector3::Constant(-1), 2, words};
}

TEST_CASE("A point is of the kind of the octant that it lies in") {
  std::vector<std::uint32_t> words{octants(SpaceKind::outside, {{1, SpaceKind::told},
                                                                {2, SpaceKind::inside},
                                                                {4, SpaceKind::far},
                                                                {6, SpaceKind::pruned}}),
                                   0};
  const SpaceTree tree = tree_of(words);
  CHECK(space_at(tree, {-0.5, -0.5, -0.5}) == SpaceKind::outside);
  CHECK(space_at(tree, {0.5, -0.5, -0.5}) == SpaceKind::told);
  CHECK(space_at(tree, {-0.5, 0.5, -0.5}) == SpaceKind::inside);
  CHECK(space_at(tree, {-0.5, -0.5, 0.5}) == SpaceKind::far);
  CHECK(space_at(tree, {-0.5, 0.5, 0.5}) == SpaceKind::pruned);
  // A wall between two belongs to the upper one, the lowest corner to the cube.
  CHECK(space_at(tree, {0, -0.5, -0.5}) == SpaceKind::told);
  CHECK(space_at(tree, {-1, -1, -1}) == SpaceKind::outside);
}

TEST_CASE("A cube is of all kinds that it touches, and far where it juts out") {
  const std::vector<std::uint32_t> words{
      octants(SpaceKind::outside,
              {{1, SpaceKind::told}, {2, SpaceKind::inside}, {6, SpaceKind::pruned}}),
      0};
  const SpaceTree tree = tree_of(words);
  CHECK(spaces_of_cube(tree, {-0.5, -0.5, -0.5}, 0.4) == space_bit(SpaceKind::outside));
  CHECK(spaces_of_cube(tree, {0, -0.5, -0.5}, 0.4) ==
        (space_bit(SpaceKind::outside) | space_bit(SpaceKind::told)));
  CHECK(spaces_of_cube(tree, {-0.5, 0.5, 0}, 0.4) ==
        (space_bit(SpaceKind::inside) | space_bit(SpaceKind::pruned)));
  CHECK(spaces_of_cube(tree, {-0.9, -0.5, -0.5}, 0.2) ==
        (space_bit(SpaceKind::outside) | space_bit(SpaceKind::far)));
}

TEST_CASE("Octants that are split lead to the kinds of their own octants") {
  const std::vector<std::uint32_t> words{
      // Three of the eight are split: nodes 1 to 3, in the order of octants.
      octants(SpaceKind::outside,
              {{0, SpaceKind::split}, {3, SpaceKind::split}, {7, SpaceKind::split}}),
      1,
      octants(SpaceKind::inside),
      0,
      octants(SpaceKind::pruned, {{4, SpaceKind::split}}),
      4,
      octants(SpaceKind::told, {{7, SpaceKind::far}}),
      0,
      octants(SpaceKind::far, {{2, SpaceKind::inside}}),
      0};
  const SpaceTree tree = tree_of(words);
  CHECK(space_at(tree, {-0.1, -0.9, -0.1}) == SpaceKind::inside);
  CHECK(space_at(tree, {0.75, 0.25, -0.25}) == SpaceKind::pruned);
  CHECK(space_at(tree, {0.5, 0.5, 0.5}) == SpaceKind::far);
  CHECK(space_at(tree, {0.75, 0.25, 0.75}) == SpaceKind::told);
  CHECK(space_at(tree, {-0.75, 0.25, 0.75}) == SpaceKind::outside);
  // Octant 4 of octant 3 is the cube from (0, 0, -0.5), of which octant 2 is told apart.
  CHECK(space_at(tree, {0.1, 0.4, -0.4}) == SpaceKind::inside);
  CHECK(space_at(tree, {0.4, 0.4, -0.4}) == SpaceKind::far);
}

TEST_CASE("Splits of space lead as deep as they may, and no deeper") {
  const Vector3 corner = Vector3::Constant(1 - 1e-9);
  for (const int nodes : {1, 2, space_levels - 1, space_levels, space_levels + 1}) {
    const std::vector<std::uint32_t> words = space_chain(nodes, SpaceKind::pruned, SpaceKind::told);
    const SpaceTree tree = tree_of(words);
    INFO(nodes << " nodes below each other");
    CHECK(space_at(tree, corner) == (nodes <= space_levels ? SpaceKind::told : SpaceKind::far));
    CHECK(space_at(tree, {-0.5, 0.9, 0.9}) == SpaceKind::pruned);
  }
}

TEST_CASE("Outside its cube space is far, and so is a point that is no number") {
  const std::vector<std::uint32_t> words{octants(SpaceKind::inside), 0};
  const SpaceTree tree = tree_of(words);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Vector3& point :
       {Vector3(1, 0, 0), Vector3(0, -1.000001, 0), Vector3(0, 0, 7), Vector3(nan, 0, 0),
        Vector3(0, infinity, 0), Vector3(0, 0, -infinity), Vector3(1e308, -1e308, 1e308)}) {
    CHECK(space_at(tree, point) == SpaceKind::far);
  }
  CHECK(space_at(tree, {0, 0, 0}) == SpaceKind::inside);
}

TEST_CASE("Damaged words of space are far, wherever they lead") {
  const Vector3 point(0.1, 0.2, 0.3);
  const std::uint32_t split = octants(SpaceKind::split);
  for (const std::vector<std::uint32_t>& words : {std::vector<std::uint32_t>{},
                                                  {octants(SpaceKind::inside)},
                                                  {split, 0},
                                                  {split, 1},
                                                  {split, 0xFFFFFFFFU},
                                                  {split, 1, split, 0}}) {
    CHECK(space_at(tree_of(words), point) == SpaceKind::far);
  }
}

TEST_CASE("Random words of space end at some kind") {
  std::mt19937_64 bits(3);
  std::vector<std::uint32_t> words(64);
  for (int trial = 0; trial < 2000; ++trial) {
    for (std::uint32_t& word : words) {
      word = static_cast<std::uint32_t>(bits());
      // Some lead on within the words.
      if (bits() % 2 == 0) word %= 32;
      if (bits() % 3 == 0) word = octants(SpaceKind::split);
    }
    const auto place = [&bits] { return static_cast<double>(bits() >> 11U) * 0x1p-52 - 1; };
    const SpaceKind kind = space_at(tree_of(words), {place(), place(), place()});
    CHECK(kind != SpaceKind::split);
    CHECK(static_cast<std::uint32_t>(kind) < 16);
  }
}

}  // namespace
}  // namespace spm
