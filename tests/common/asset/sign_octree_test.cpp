// SPDX-License-Identifier: Apache-2.0
#include "common/asset/sign_octree.hpp"

#include <catch2/catch.hpp>
#include <limits>
#include <random>
#include <vector>

#include "tests/support/tree_by_hand.hpp"

namespace spm::sign_octree_test {
namespace {

using test::octants;
using test::sign_octree_chain;

/// A tree over the cube from (-1, -1, -1) to (1, 1, 1).
SignOctree tree_of(const std::vector<std::uint32_t>& words) {
  return {Vector3::Constant(-1), 2, words};
}

TEST_CASE("A point is of the kind of the octant that it lies in") {
  std::vector<std::uint32_t> words{octants(SignKind::outside, {{1, SignKind::boundary},
                                                               {2, SignKind::inside},
                                                               {4, SignKind::far},
                                                               {6, SignKind::pruned}}),
                                   0};
  const SignOctree tree = tree_of(words);
  CHECK(sign_at(tree, {-0.5, -0.5, -0.5}) == SignKind::outside);
  CHECK(sign_at(tree, {0.5, -0.5, -0.5}) == SignKind::boundary);
  CHECK(sign_at(tree, {-0.5, 0.5, -0.5}) == SignKind::inside);
  CHECK(sign_at(tree, {-0.5, -0.5, 0.5}) == SignKind::far);
  CHECK(sign_at(tree, {-0.5, 0.5, 0.5}) == SignKind::pruned);
  // A wall between two octants belongs to the upper one. The lowest corner belongs to the cube.
  CHECK(sign_at(tree, {0, -0.5, -0.5}) == SignKind::boundary);
  CHECK(sign_at(tree, {-1, -1, -1}) == SignKind::outside);
}

TEST_CASE("A cube is of all kinds that it touches, and far where it juts out") {
  const std::vector<std::uint32_t> words{
      octants(SignKind::outside,
              {{1, SignKind::boundary}, {2, SignKind::inside}, {6, SignKind::pruned}}),
      0};
  const SignOctree tree = tree_of(words);
  CHECK(signs_of_cube(tree, {-0.5, -0.5, -0.5}, 0.4) == sign_bit(SignKind::outside));
  CHECK(signs_of_cube(tree, {0, -0.5, -0.5}, 0.4) ==
        (sign_bit(SignKind::outside) | sign_bit(SignKind::boundary)));
  CHECK(signs_of_cube(tree, {-0.5, 0.5, 0}, 0.4) ==
        (sign_bit(SignKind::inside) | sign_bit(SignKind::pruned)));
  CHECK(signs_of_cube(tree, {-0.9, -0.5, -0.5}, 0.2) ==
        (sign_bit(SignKind::outside) | sign_bit(SignKind::far)));
}

TEST_CASE("Octants that are split lead to the kinds of their own octants") {
  const std::vector<std::uint32_t> words{
      // Three of the eight are split: nodes 1 to 3, in the order of octants.
      octants(SignKind::outside,
              {{0, SignKind::split}, {3, SignKind::split}, {7, SignKind::split}}),
      1,
      octants(SignKind::inside),
      0,
      octants(SignKind::pruned, {{4, SignKind::split}}),
      4,
      octants(SignKind::boundary, {{7, SignKind::far}}),
      0,
      octants(SignKind::far, {{2, SignKind::inside}}),
      0};
  const SignOctree tree = tree_of(words);
  CHECK(sign_at(tree, {-0.1, -0.9, -0.1}) == SignKind::inside);
  CHECK(sign_at(tree, {0.75, 0.25, -0.25}) == SignKind::pruned);
  CHECK(sign_at(tree, {0.5, 0.5, 0.5}) == SignKind::far);
  CHECK(sign_at(tree, {0.75, 0.25, 0.75}) == SignKind::boundary);
  CHECK(sign_at(tree, {-0.75, 0.25, 0.75}) == SignKind::outside);
  // Octant 4 of octant 3 is the cube from (0, 0, -0.5). Its octant 2 differs from the others.
  CHECK(sign_at(tree, {0.1, 0.4, -0.4}) == SignKind::inside);
  CHECK(sign_at(tree, {0.4, 0.4, -0.4}) == SignKind::far);
}

TEST_CASE("Splits of space lead as deep as they may, and no deeper") {
  const Vector3 corner = Vector3::Constant(1 - 1e-9);
  for (const int nodes :
       {1, 2, sign_octree_levels - 1, sign_octree_levels, sign_octree_levels + 1}) {
    const std::vector<std::uint32_t> words =
        sign_octree_chain(nodes, SignKind::pruned, SignKind::boundary);
    const SignOctree tree = tree_of(words);
    INFO(nodes << " nodes below each other");
    CHECK(sign_at(tree, corner) ==
          (nodes <= sign_octree_levels ? SignKind::boundary : SignKind::far));
    CHECK(sign_at(tree, {-0.5, 0.9, 0.9}) == SignKind::pruned);
  }
}

TEST_CASE("Outside its cube space is far, and so is a point that is no number") {
  const std::vector<std::uint32_t> words{octants(SignKind::inside), 0};
  const SignOctree tree = tree_of(words);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Vector3& point :
       {Vector3(1, 0, 0), Vector3(0, -1.000001, 0), Vector3(0, 0, 7), Vector3(nan, 0, 0),
        Vector3(0, infinity, 0), Vector3(0, 0, -infinity), Vector3(1e308, -1e308, 1e308)}) {
    CHECK(sign_at(tree, point) == SignKind::far);
  }
  CHECK(sign_at(tree, {0, 0, 0}) == SignKind::inside);
}

TEST_CASE("Damaged words of space are far, wherever they lead") {
  const Vector3 point(0.1, 0.2, 0.3);
  const std::uint32_t split = octants(SignKind::split);
  for (const std::vector<std::uint32_t>& words : {std::vector<std::uint32_t>{},
                                                  {octants(SignKind::inside)},
                                                  {split, 0},
                                                  {split, 1},
                                                  {split, 0xFFFFFFFFU},
                                                  {split, 1, split, 0}}) {
    CHECK(sign_at(tree_of(words), point) == SignKind::far);
  }
}

TEST_CASE("Random words of space end at some kind") {
  std::mt19937_64 bits(3);
  std::vector<std::uint32_t> words(64);
  for (int trial = 0; trial < 2000; ++trial) {
    for (std::uint32_t& word : words) {
      word = static_cast<std::uint32_t>(bits());
      // Some words lead to nodes that exist.
      if (bits() % 2 == 0) word %= 32;
      if (bits() % 3 == 0) word = octants(SignKind::split);
    }
    const auto place = [&bits] { return static_cast<double>(bits() >> 11U) * 0x1p-52 - 1; };
    const SignKind kind = sign_at(tree_of(words), {place(), place(), place()});
    CHECK(kind != SignKind::split);
    CHECK(static_cast<std::uint32_t>(kind) < 16);
  }
}

}  // namespace
}  // namespace spm::sign_octree_test
