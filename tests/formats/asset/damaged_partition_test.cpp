// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <functional>

#include "common/asset/grid_list.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "tests/formats/asset/damage.hpp"
#include "tests/formats/support/synthetic_asset.hpp"
#include "tests/support/octree_by_hand.hpp"

namespace damaged_partition_test {

// Assets whose grid or octree points to something that does not exist, or whose triangles are not
// where it says, in files that are otherwise right.

namespace {

using namespace spm;
using namespace spm::test;

/// First cell of the grid whose word leads to a record and has these bits.
std::uint64_t record_cell(const Asset& asset, std::uint32_t bits) {
  std::uint64_t cell = 0;
  while (asset.grid.index[cell] >> 28U != (8U | bits >> 28U)) ++cell;
  return cell;
}

std::vector<Damage> wrong_grids() {
  const Asset asset = full_asset(1, {2, 2, 1, 12, 2});
  const std::string full = baked(asset);
  const std::uint64_t list_cell = record_cell(asset, 0);
  const auto index = flat_word(full, "grid_index", list_cell);
  const auto list = flat_word(full, "grid_records", asset.grid.index[list_cell] & offset_mask);
  const std::uint32_t split_word = asset.grid.index[record_cell(asset, split_bit)];
  const auto split = flat_word(full, "grid_records", split_word & offset_mask);
  const auto last = static_cast<std::uint32_t>(asset.grid.records.size() - 1);
  constexpr std::uint32_t record = 2U << 30U;
  const std::string cell = "the record of grid cell " + std::to_string(list_cell) + " ";
  return {
      {"a list outside", with_word(full, index, record | offset_mask), cell + "lies outside"},
      {"a split outside", with_word(full, index, record | split_bit | offset_mask),
       cell + "lies outside"},
      {"a split cut short", with_word(full, index, record | split_bit | last),
       cell + "is cut short"},
      {"a split that holds itself", with_word(full, split, split_word), "is split too often"},
      {"a list cut short", with_word(full, list, list_header(255, 65535)), "is cut short"},
      {"a list of later bits", with_word(full, list, 1U << 26U), "is cut short"},
      {"a list with a map that is not", with_word(full, list + 4, 5),
       "names a map that does not exist"},
      {"a list with a layer that is not", with_word(full, list + 4, pack_candidate({2, 1})),
       "names a map that does not exist"},
      {"a list with a triangle that is not",
       with_word(with_word(full, list, list_header(0, 1)), list + 4, 10),
       "names a triangle that does not exist"},
  };
}

/// A sparse asset with one change, as it would be baked.
std::string sparse_with(const std::function<void(Asset&)>& change) {
  Asset asset = sparse_asset(1);
  change(asset);
  return baked(asset);
}

/// A sparse asset whose first root is this word, and all others far.
std::string with_cubes(std::uint32_t root, const std::vector<std::uint32_t>& units) {
  return sparse_with([&](Asset& asset) {
    for (std::uint32_t& word : asset.octree.root_words) word = root_word(OctreeKind::far, 9);
    asset.octree.root_words.front() = root;
    asset.octree.words = units;
  });
}

/// Of one cube, with its words.
std::string with_cube(OctreeKind kind, const std::vector<std::uint32_t>& words) {
  return with_cubes(root_word(kind, 0), words);
}

constexpr auto split = OctreeKind::split, far_kind = OctreeKind::far, deep = OctreeKind::deep;
constexpr auto list = OctreeKind::list, map = OctreeKind::map;

std::vector<Damage> wrong_cubes() {
  const std::string shared = "a cube of its octree shares its words with another";
  const std::string cut = "a cube of its octree is cut short";
  const std::string no_kind = "a cube of its octree is of no kind";
  std::vector<Damage> cases = {
      {"two roots with the same words", sparse_with([](Asset& asset) {
         asset.octree.root_words[0] = asset.octree.root_words[1] = root_word(deep, 0);
       }),
       shared},
      {"a cube that leads to itself",
       with_cubes(root_word(split, 0), {0, octant_kinds(far_kind, {{0, split}})}), shared},
      {"a cube that leads upwards",
       with_cubes(root_word(split, 0), {2, octant_kinds(far_kind, {{3, split}}), 0,
                                        octant_kinds(far_kind, {{5, split}})}),
       shared},
      {"a cube in the middle of another's words",
       with_cubes(root_word(split, 0), {2, octant_kinds(far_kind, {{0, split}, {1, split}}), 0, 0,
                                        3, octant_kinds(far_kind, {{0, map}})}),
       shared},
      {"a root that leads outside", with_cubes(root_word(deep, 2), {0, 0}), cut},
      {"a root that leads far outside", with_cubes(root_word(split, 0x0FFFFFFF), {0, 0}), cut},
      {"a list of which half is there", with_cube(list, {0}), cut},
      {"a map cut short", with_cube(map, {}), cut},
      {"a map behind the last word", with_cubes(root_word(map, 1), {0}), cut},
      {"two maps with the same word", sparse_with([](Asset& asset) {
         asset.octree.root_words[0] = asset.octree.root_words[1] = root_word(map, 0);
       }),
       shared},
      {"a map whose word is its own cube's",
       with_cubes(root_word(split, 0), {1, octant_kinds(far_kind, {{0, map}})}), shared},
      {"octants that lead outside", with_cube(split, {2, octant_kinds(far_kind, {{2, deep}})}),
       cut},
      {"octants of which the last lies outside",
       with_cube(split, {2, octant_kinds(far_kind, {{2, deep}, {7, map}}), 0}), cut},
      {"octants that lead beyond all numbers",
       with_cube(split, {0xFFFFFFFFU, octant_kinds(far_kind, {{2, deep}, {7, deep}})}), cut},
      {"splits below each other beyond the last level",
       with_cubes(root_word(split, 0), chain_of_splits(max_octree_levels + 1, far_kind, far_kind)),
       "a cube of its octree is split too often"},
  };
  for (const std::uint32_t kind : {2U, 3U, 6U, 7U, 10U, 11U, 12U, 13U, 14U, 15U}) {
    const auto unknown = static_cast<OctreeKind>(kind);
    cases.push_back(
        {"a root of kind " + std::to_string(kind), with_cube(unknown, {0, 0}), no_kind});
    cases.push_back({"an octant of kind " + std::to_string(kind),
                     with_cube(split, {0, octant_kinds(far_kind, {{6, unknown}})}), no_kind});
  }
  return cases;
}

std::vector<Damage> wrong_lists() {
  const auto words = static_cast<std::uint32_t>(sparse_asset(1).octree.lists.size());
  const std::string cut = "a cube of its octree has a list that is cut short";
  const std::string empty = "a cube of its octree has a list without triangles";
  const std::string no_side = "a cube of its octree has a list of no side";
  const std::string none = "a cube of its octree names triangles that do not exist";
  constexpr auto surface = ListSide::surface;
  const auto with_list = [&](std::uint32_t first, std::uint32_t word) {
    return with_cube(list, {first, word});
  };
  const auto with_numbers = [&](const std::vector<std::uint32_t>& list_words, bool wide) {
    return sparse_with([&](Asset& asset) {
      const auto first = static_cast<std::uint32_t>(asset.octree.lists.size());
      asset.octree.lists.insert(asset.octree.lists.end(), list_words.begin(), list_words.end());
      for (std::uint32_t& word : asset.octree.root_words) word = root_word(OctreeKind::far, 9);
      asset.octree.root_words.front() = root_word(list, 0);
      asset.octree.words = {first, list_word(2, 0, surface, wide)};
    });
  };
  return {
      {"a list cut short", with_list(words - 1, list_word(2, 0, surface, false)), cut},
      {"a list of all triangles there may be",
       with_list(0, list_word(max_listed_of_kind, 0, surface, false)), cut},
      {"a list of all sheets there may be",
       with_list(0, list_word(1, max_listed_of_kind, surface, true)), cut},
      {"a list outside", with_list(words, list_word(1, 0, surface, false)), cut},
      {"a list far outside", with_list(0xFFFFFFFFU, list_word(1, 0, surface, false)), cut},
      {"a list of nothing", with_list(0, list_word(0, 0, surface, false)), empty},
      {"a list of a side that is not",
       with_list(0, list_word(1, 0, static_cast<ListSide>(list_side_codes), false)), no_side},
      {"a list of a triangle that does not exist", with_numbers({0, 0xFFFF0000U}, false), none},
      {"a wide list of one", with_numbers({0, 0, 0x7FFFFFFFU}, true), none},
      {"a list from beyond all triangles", with_numbers({list_first_mask, 0}, false), none},
      {"a list that is crossed beyond its end", with_numbers({0xFFFFFFF0U, 0}, false), cut},
      {"lists that share a part", sparse_with([&](Asset& asset) {
         const auto first = static_cast<std::uint32_t>(asset.octree.lists.size());
         asset.octree.lists.insert(asset.octree.lists.end(), {0, 0, 0});
         asset.octree.root_words[0] = root_word(list, 0);
         asset.octree.root_words[1] = root_word(list, 2);
         for (std::size_t k = 2; k < asset.octree.root_words.size(); ++k) {
           asset.octree.root_words[k] = root_word(OctreeKind::far, 9);
         }
         asset.octree.words = {first, list_word(2, 0, surface, false), first + 1,
                               list_word(2, 0, surface, false)};
       }),
       "a cube of its octree shares a part of its list with another"},
  };
}

std::vector<Damage> wrong_maps() {
  const std::string none = "a cube of its octree names a distance map that does not exist";
  constexpr std::uint32_t last = max_named_maps;
  return {
      {"a map that does not exist", with_cube(map, {word_of_map(6)}), none},
      {"the last map there may be", with_cube(map, {word_of_map(last)}), none},
      {"a map in an asset without maps",
       [] {
         Asset asset = sparse_asset(1, {.planes = 0, .triangles = 0});
         asset.octree.root_words[0] = root_word(map, 0);
         asset.octree.words.assign(1, word_of_map(0));
         for (std::size_t k = 1; k < asset.octree.root_words.size(); ++k) {
           asset.octree.root_words[k] = root_word(far_kind, 0);
         }
         return baked(asset);
       }(),
       none},
      {"a first of two that does not exist", with_cube(map, {word_of_maps(6, 0, {})}), none},
      {"a second map that does not exist", with_cube(map, {word_of_maps(0, 6, {})}), none},
      {"a second that is the last there may be", with_cube(map, {word_of_maps(0, last - 1, {})}),
       none},
      {"a second map that is none", with_cube(map, {1U << 31U}), none},
      {"an edge of one map", with_cube(map, {1U << 15U}), none},
      {"an octant's map that does not exist",
       with_cube(split,
                 {2, octant_kinds(far_kind, {{0, map}, {7, map}}), word_of_map(5), word_of_map(6)}),
       none},
  };
}

std::vector<Damage> wrong_triangles() {
  const std::string hidden =
      "a cube of its octree says that the surface is not in it, but a triangle is";
  const auto with_corner = [](unsigned which, std::uint32_t corner) {
    return sparse_with([=](Asset& asset) {
      const std::uint64_t three = long_word(asset.octree.triangles, 0);
      std::array<std::uint32_t, 3> numbers{unpack_third(three, 0), unpack_third(three, 1),
                                           unpack_third(three, 2)};
      numbers.at(which) = corner;
      const std::uint64_t changed = pack_three(numbers);
      std::memcpy(asset.octree.triangles.data(), &changed, sizeof changed);
    });
  };
  const auto corners = static_cast<std::uint32_t>(sparse_asset(1).octree.corners.size() / 2);
  const std::string no_corner = "a triangle has a corner that does not exist";
  return {
      {"a first corner that is not there", with_corner(0, corners), no_corner},
      {"a last corner far from any", with_corner(2, corner_mask), no_corner},
      {"far cubes where triangles are", with_cubes(root_word(far_kind, 0), {0, 0}), hidden},
      {"deep cubes where triangles are", sparse_with([](Asset& asset) {
         const auto roots = static_cast<std::uint32_t>(asset.octree.root_words.size());
         asset.octree.words.assign(roots, 0);
         for (std::uint32_t k = 0; k < roots; ++k) {
           asset.octree.root_words[k] = root_word(deep, k);
         }
       }),
       hidden},
      {"a triangle outside all cubes",
       sparse_with([](Asset& asset) { asset.octree.lattice_origin.x() += 1; }),
       "a triangle lies outside its octree"},
  };
}

void check_opens(const std::string& bytes) {
  const TemporaryFolder folder;
  write_bytes(folder.path("a.spm.exr"), bytes);
  const auto opened = MappedAsset::open(folder.path("a.spm.exr"));
  INFO((opened ? std::string() : opened.error().message));
  CHECK(opened.has_value());
}

}  // namespace

TEST_CASE("An asset whose grid leads astray is refused") { check_all_refused(wrong_grids()); }

TEST_CASE("An asset whose octree leads astray is refused") { check_all_refused(wrong_cubes()); }

TEST_CASE("An asset whose lists of triangles lead astray is refused") {
  check_all_refused(wrong_lists());
}

TEST_CASE("An asset whose octree names maps that it does not have is refused") {
  check_all_refused(wrong_maps());
}

TEST_CASE(
    "An asset whose triangles have no corners, or lie where its octree has no surface, is "
    "refused") {
  check_all_refused(wrong_triangles());
}

TEST_CASE("Cubes as deep as they may be, and the last map and triangles, are accepted") {
  const auto alone = [](std::uint32_t root, const std::vector<std::uint32_t>& units) {
    Asset asset = sparse_asset(1, {.triangles = 0});
    for (std::uint32_t& word : asset.octree.root_words) word = root_word(far_kind, 0);
    asset.octree.root_words.back() = root;
    asset.octree.words = units;
    return baked(asset);
  };
  check_opens(alone(root_word(split, 0), chain_of_splits(max_octree_levels, far_kind, far_kind)));
  check_opens(alone(root_word(far_kind, 0x0FFFFFFF), {}));
  check_opens(alone(root_word(map, 0), {word_of_map(5)}));
  for (const bool larger : {false, true}) {
    for (const bool edge : {false, true}) {
      check_opens(alone(root_word(map, 0), {word_of_maps(5, 5, {larger, edge})}));
    }
  }
  check_opens(sparse_with([](Asset& asset) {
    const auto last = static_cast<std::uint32_t>(asset.octree.triangles.size() / 2 - 1);
    const auto unit = add_list(asset.octree, {last, 0, last});
    for (std::uint32_t& word : asset.octree.root_words) word = root_word(list, 0);
    for (std::size_t k = 1; k < asset.octree.root_words.size(); ++k) {
      asset.octree.root_words[k] = root_word(OctreeKind::pruned, 0);
    }
    asset.octree.words = {unit[0], unit[1]};
  }));
}

TEST_CASE("Where an asset thins its band, cubes may be far or deep though a triangle is there") {
  const auto far_everywhere = [](const Band& band) {
    Asset asset = sparse_asset(1);
    asset.metadata.band = band;
    for (std::uint32_t& word : asset.octree.root_words) word = root_word(far_kind, 0);
    return baked(asset);
  };
  check_opens(far_everywhere({.max_depth = 0, .margin = 0.0005}));
  check_opens(far_everywhere({.max_depth = 0.002, .margin = 0}));
  check_all_refused({{"a wide band", far_everywhere({.max_depth = 0.001, .margin = 0.0005}),
                      "says that the surface is not in it"}});
}

}  // namespace damaged_partition_test
