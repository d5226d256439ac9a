// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <functional>

#include "common/asset/grid_list.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "tests/formats/asset/damage.hpp"
#include "tests/formats/support/synthetic_asset.hpp"
#include "tests/support/tree_by_hand.hpp"

namespace damaged_partition_test {

// Assets whose grid, space or tree of elements points to something that does not exist, in files
// that are otherwise right.

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

std::string with_sign_octree(const std::vector<std::uint32_t>& words) {
  return sparse_with([&words](Asset& asset) { asset.sign_octree.words = words; });
}

std::string with_first_child(const BvhChild& child) {
  return sparse_with([&child](Asset& asset) { asset.bvh.words[0] = pack_child(child); });
}

std::string with_last_child(const BvhChild& child) {
  return sparse_with([&child](Asset& asset) {
    asset.bvh.words[asset.bvh.words.size() - bvh_node_words] = pack_child(child);
  });
}

/// A chain of this many nodes, one below the other.
std::vector<std::uint32_t> chain_of_nodes(int nodes) {
  std::vector<std::uint32_t> words;
  for (int node = 1; node < nodes; ++node) {
    add_bvh_node(words, {node_child(static_cast<std::uint32_t>(node))});
  }
  add_bvh_node(words, {tile_child(0)});
  return words;
}

std::uint32_t kind_of(std::uint32_t kind) { return octants(static_cast<SignKind>(kind)); }

std::vector<Damage> wrong_sign_octrees() {
  const std::uint32_t split = octants(SignKind::outside, {{3, SignKind::split}});
  const std::uint32_t two_splits =
      octants(SignKind::outside, {{3, SignKind::split}, {4, SignKind::split}});
  const std::uint32_t whole = octants(SignKind::boundary);
  const std::string none_below = "a cube of its sign octree leads to no cube below it";
  const std::string no_kind = "a cube of its sign octree is of no kind";
  return {
      {"a cube that leads to itself", with_sign_octree({split, 0}), none_below},
      {"a cube that leads upwards", with_sign_octree({split, 1, split, 0}), none_below},
      {"a cube below that leads to itself", with_sign_octree({split, 1, split, 1}), none_below},
      {"a cube that leads outside", with_sign_octree({split, 2, whole, 0}), none_below},
      {"a cube that leads far outside", with_sign_octree({split, 0xFFFFFFFFU, whole, 0}),
       none_below},
      {"a split cut short", with_sign_octree({two_splits, 1, whole, 0}), none_below},
      {"a kind that is not", with_sign_octree({kind_of(5), 0}), no_kind},
      {"another", with_sign_octree({kind_of(6), 0}), no_kind},
      {"a kind of later bits", with_sign_octree({split, 1, kind_of(8), 0}), no_kind},
      {"a kind of all bits", with_sign_octree({split, 1, kind_of(15), 0}), no_kind},
      {"one octant of no kind",
       with_sign_octree({octants(SignKind::boundary, {{7, static_cast<SignKind>(9)}}), 0}),
       no_kind},
      {"splits below each other beyond the last level",
       with_sign_octree(
           sign_octree_chain(sign_octree_levels + 1, SignKind::inside, SignKind::boundary)),
       "a cube of its sign octree is split too often"},
  };
}

std::vector<Damage> wrong_trees() {
  const Asset asset = sparse_asset(1);
  const auto nodes = static_cast<std::uint32_t>(asset.bvh.words.size() / bvh_node_words);
  const std::string none_below = "a box of its elements leads to no box below it";
  const std::string no_tile = "a box of its elements names a tile that does not exist";
  const std::string no_triangle = "a box of its elements names a triangle that does not exist";
  return {
      {"a box that leads to itself", with_first_child({ElementKind::node, 0, 1}), none_below},
      {"the last box that leads to itself", with_last_child({ElementKind::node, nodes - 1, 1}),
       none_below},
      {"a box that leads upwards", with_last_child({ElementKind::node, 1, 1}), none_below},
      {"a box that leads outside", with_first_child({ElementKind::node, nodes, 1}), none_below},
      {"a tile that is not", with_first_child({ElementKind::tile, 100, 1}), no_tile},
      {"a tile far from any", with_last_child({ElementKind::tile, 0xFFFFFF, 1}), no_tile},
      {"a triangle that is not", with_first_child({ElementKind::fan, 60, 1}), no_triangle},
      {"a fan of which the last triangle is not", with_last_child({ElementKind::fan, 56, 3}),
       no_triangle},
      {"a fan of small triangles of which the last is not",
       [] {
         Asset small = sparse_asset(1, {.small = true});
         small.bvh.words[0] = pack_child({ElementKind::fan, 20, 39});
         return baked(small);
       }(),
       no_triangle},
      {"boxes below each other beyond the last level",
       sparse_with([](Asset& a) { a.bvh.words = chain_of_nodes(bvh_levels + 1); }),
       "a box of its elements lies too deep"},
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

TEST_CASE("An asset whose space leads astray is refused") {
  check_all_refused(wrong_sign_octrees());
}

TEST_CASE("An asset whose tree of elements leads astray is refused") {
  check_all_refused(wrong_trees());
}

TEST_CASE("Trees as deep as they may be, and the last tile and triangle, are accepted") {
  check_opens(with_sign_octree(
      sign_octree_chain(sign_octree_levels, SignKind::inside, SignKind::boundary)));
  check_opens(sparse_with([](Asset& a) { a.bvh.words = chain_of_nodes(bvh_levels); }));
  check_opens(with_first_child({ElementKind::tile, 99, 1}));
  check_opens(with_first_child({ElementKind::fan, 20, 38}));
  check_opens(with_first_child({ElementKind::none, 0, 1}));
}

}  // namespace damaged_partition_test
