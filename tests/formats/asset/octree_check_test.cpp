// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/octree_check.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "common/query/octree_query.hpp"
#include "tests/formats/support/synthetic_asset.hpp"
#include "tests/support/octree_by_hand.hpp"

namespace octree_check_test {

namespace {

using namespace spm;
using namespace spm::test;

/// The check of an asset in memory.
struct Checked {
  std::string problem;
  std::size_t steps = 0;

  explicit Checked(const Asset& asset) {
    const AssetTables tables = tables_of(asset);
    problem = octree_problem(tables.view(), &steps);
  }
};

/// What may be looked at: each root, the octants of each two words, what each word of a list names,
/// each triangle.
std::size_t most_steps(const OctreeData& octree) {
  return octree.root_words.size() + 8 * (octree.words.size() / 2) + 2 * octree.lists.size() +
         octree.triangles.size() / 2;
}

/// An asset of this many splits and nothing else; octants of all are splits from one word on.
Asset all_splits(std::uint32_t count, std::uint32_t first) {
  Asset asset = sparse_asset(1, {.planes = 0, .triangles = 0});
  asset.octree.root_words.assign(48, root_word(OctreeKind::split, 0));
  asset.octree.words.clear();
  for (std::uint32_t k = 0; k < count; ++k) {
    asset.octree.words.push_back(first);
    asset.octree.words.push_back(octant_kinds(OctreeKind::split));
  }
  return asset;
}

}  // namespace

TEST_CASE("An octree of roots alone, all of them far or left out, answers so") {
  Asset asset = sparse_asset(6, {.triangles = 0});
  asset.octree.words.clear();
  for (std::uint32_t& word : asset.octree.root_words) word = root_word(OctreeKind::far, 70);
  asset.octree.root_words.front() = root_word(OctreeKind::pruned, 0);
  CHECK(Checked(asset).problem.empty());
  const AssetTables tables = tables_of(asset);
  const Vector3 first = asset.octree.origin + Vector3::Constant(asset.octree.edge / 2);
  CHECK(query_point(tables.view(), first).status == Status::pruned);
  const Vector3 second = first + asset.octree.edge * Vector3::UnitX();
  CHECK(query_point(tables.view(), second).status == Status::far);
  const double way = asset.octree.edge / 2;
  CHECK(clearance(tables.view(), second) ==
        Approx(std::max(0.007, tables.view().band.margin + way)));
}

TEST_CASE("A triangle that lies outside its octree is refused, whatever the tolerance") {
  Asset asset = sparse_asset(1);
  REQUIRE(Checked(asset).problem.empty());
  asset.metadata.tolerance = 1e11;  // with which the band is no check
  CHECK(Checked(asset).problem.empty());
  asset.octree.lattice_step = 1e3;
  CHECK(Checked(asset).problem == "a triangle lies outside its octree");
  asset = sparse_asset(1);
  asset.metadata.tolerance = 1e11;
  asset.octree.lattice_origin.y() += 1;
  CHECK(Checked(asset).problem == "a triangle lies outside its octree");
}

TEST_CASE("A list names no triangle beyond the last one") {
  Asset asset = sparse_asset(1, {.planes = 0, .triangles = 10});
  OctreeData& octree = asset.octree;
  const auto with = [&](std::uint32_t last) {
    octree.lists.clear();
    const auto unit = add_list(octree, {0, last});
    octree.root_words.assign(48, root_word(OctreeKind::pruned, 0));
    octree.root_words[0] = root_word(OctreeKind::list, 0);
    octree.words.assign(unit.begin(), unit.end());
    asset.metadata.tolerance = 1;  // with which the band is no check
    return Checked(asset).problem;
  };
  CHECK(with(9).empty());
  CHECK(with(10) == "a cube of its octree names triangles that do not exist");
}

TEST_CASE("Each cube, listed triangle and triangle is looked at once") {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Asset asset = sparse_asset(seed);
    const Checked checked(asset);
    CHECK(checked.problem.empty());
    CHECK(checked.steps > asset.octree.root_words.size() + asset.octree.lists.size());
    CHECK(checked.steps <= most_steps(asset.octree));
  }
}

TEST_CASE("Splits that all name the same octants are refused when the second one is met") {
  for (const std::uint32_t first : {0U, 2U, 16U, 2000U}) {
    Asset asset = all_splits(2000, first);
    // Twelve levels of them would be 8^12 cubes.
    CHECK(Checked(asset).problem == "a cube of its octree shares its words with another");
    CHECK(Checked(asset).steps <= 3);
    asset.octree.root_words.assign(48, root_word(OctreeKind::far, 0));
    asset.octree.root_words[0] = root_word(OctreeKind::split, 3998);
    const Checked one_root(asset);
    CHECK(one_root.problem == "a cube of its octree shares its words with another");
    CHECK(one_root.steps <= most_steps(asset.octree));
  }
}

TEST_CASE("Many cubes with the same list cost no more than one") {
  Asset asset = sparse_asset(1, {.planes = 0, .triangles = 8000});
  OctreeData& octree = asset.octree;
  octree.lists.clear();
  std::vector<std::uint32_t> all;
  for (std::uint32_t k = 0; k < max_listed_of_kind; ++k) all.push_back(0);
  const auto unit = add_list(octree, all);
  octree.words.clear();
  // Each root is split, and each of its octants has the whole list, of any side.
  const std::uint32_t roots = 48;
  for (std::uint32_t root = 0; root < roots; ++root) {
    octree.root_words[root] = root_word(OctreeKind::split, 2 * root);
    octree.words.insert(octree.words.end(),
                        {2 * (roots + 8 * root), octant_kinds(OctreeKind::list)});
  }
  for (std::uint32_t k = 0; k < 8 * roots; ++k) {
    const std::uint32_t side = list_word(0, 0, static_cast<ListSide>(k % 3), false);
    octree.words.insert(octree.words.end(), {unit[0], unit[1] | side});
  }
  const Checked checked(asset);
  CHECK(checked.problem.empty());
  CHECK(checked.steps == roots + 8 * roots + max_listed_of_kind + octree.triangles.size() / 2);
  // Lists that begin one word after the other, in each other, could cost as much as their product.
  for (std::uint32_t k = 0; k < 8 * roots; ++k) {
    octree.words[2 * (roots + k)] = unit[0] + k;
    octree.words[2 * (roots + k) + 1] = list_word(1000, 0, ListSide::surface, false);
  }
  const Checked nested(asset);
  CHECK(nested.problem == "a cube of its octree shares a part of its list with another");
  CHECK(nested.steps <= most_steps(octree));
}

TEST_CASE("Any word that names maps that exist is accepted and gives finite answers") {
  Asset asset = sparse_asset(6, {.charts = 6, .triangles = 0});
  OctreeData& octree = asset.octree;
  octree.root_words.assign(octree.root_words.size(), root_word(OctreeKind::far, 0));
  octree.root_words[0] = root_word(OctreeKind::map, 0);
  constexpr std::uint32_t larger = 1U << 31U, edge = 1U << 15U;
  Random random(12);
  int accepted = 0, answered = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    auto word = static_cast<std::uint32_t>(random.next());
    // Mostly nearer to the maps that there are.
    if (below(random, 8) != 0) word &= larger | edge | 7U << 16U | 7U;
    octree.words = {word};
    const std::uint32_t first = word & (edge - 1), second_from_one = (word & ~larger) >> 16U;
    const bool exist = first < 6 && second_from_one <= 6 &&
                       (second_from_one != 0 || (word & (larger | edge)) == 0);
    const std::string problem = Checked(asset).problem;
    REQUIRE(problem ==
            (exist ? "" : "a cube of its octree names a distance map that does not exist"));
    if (!exist) continue;
    ++accepted;
    const AssetTables tables = tables_of(asset);
    for (std::uint32_t k = 0; k < 20; ++k) {
      const auto share = [&] {
        return k < 8 ? (below(random, 2) == 0 ? 0 : 0.999999) : random.between(0, 1);
      };
      const Vector3 point = octree.origin + octree.edge * Vector3(share(), share(), share());
      const Leaf leaf = leaf_at(tables.view().octree, point);
      REQUIRE(leaf.kind == OctreeKind::map);
      const Answer answer = query_leaf(tables.view(), leaf, point);
      if (answer.status == Status::far) continue;  // not on a map
      ++answered;
      REQUIRE(std::isfinite(answer.distance));
      REQUIRE(answer.normal.norm() == Approx(1));
    }
  }
  CHECK(accepted > 1000);
  CHECK(answered > 10000);
}

TEST_CASE("A cube in the band that is said to be far is found only where a triangle lies in it") {
  Asset asset = sparse_asset(1);
  const AssetTables tables = tables_of(asset);
  // Makes each root far that no triangle passes, whatever its answers were.
  std::vector<bool> passed(asset.octree.root_words.size(), false);
  const auto& roots = asset.octree.roots;
  const IndexedTriangles& exact = tables.view().exact;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    for (const Vector3& corner : corners_of(exact, i)) {
      const Vector3 at = (corner - asset.octree.origin) / asset.octree.edge;
      passed.at(static_cast<std::size_t>(at.x()) +
                roots[0] * (static_cast<std::size_t>(at.y()) +
                            roots[1] * static_cast<std::size_t>(at.z()))) = true;
    }
  }
  std::size_t made_far = 0;
  for (std::size_t k = 0; k < passed.size(); ++k) {
    std::uint32_t& word = asset.octree.root_words[k];
    if (passed[k] || static_cast<OctreeKind>(word & 15U) == OctreeKind::far) continue;
    word = root_word(OctreeKind::far, 0);
    ++made_far;
  }
  REQUIRE(made_far > 0);
  CHECK(Checked(asset).problem.empty());
  // The checksum is what such words do not come through.
}

TEST_CASE("The time of a check does not depend on what hostile words say") {
  Random random(4);
  for (int trial = 0; trial < 2000; ++trial) {
    Asset asset = sparse_asset(1, {.planes = 3, .triangles = 40});
    OctreeData& octree = asset.octree;
    // Splits everywhere, of octants that may be anywhere.
    for (std::size_t k = 0; k + 1 < octree.words.size(); k += 2) {
      if (below(random, 4) != 0) continue;
      octree.words[k] = below(random, static_cast<std::uint32_t>(octree.words.size()));
      octree.words[k + 1] = octant_kinds(OctreeKind::split);
    }
    for (std::uint32_t& word : octree.root_words) {
      if (below(random, 8) == 0) {
        word = root_word(OctreeKind::split,
                         below(random, static_cast<std::uint32_t>(octree.words.size())));
      }
    }
    const Checked checked(asset);
    REQUIRE(!checked.problem.empty());
    REQUIRE(checked.steps <= most_steps(octree));
  }
}

}  // namespace octree_check_test
