// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "common/query/query.hpp"
#include "formats/asset/asset_writer.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "formats/exr/exr_layout.hpp"
#include "formats/files/sha256.hpp"
#include "tests/formats/support/exr_by_hand.hpp"
#include "tests/formats/support/synthetic_asset.hpp"

namespace round_trip_test {

namespace {

using namespace spm;
using namespace spm::test;

const std::vector<std::uint32_t> many_layers{2, 2, 1, 12, 2, 3, 2, 1, 12, 2, 2, 1, 2};

std::unique_ptr<MappedAsset> written_and_opened(const Asset& asset, const std::string& path,
                                                const MapOptions& options = {}) {
  const auto written = write_asset(asset, path);
  INFO((written ? std::string() : written.error().message));
  REQUIRE(written.has_value());
  auto opened = MappedAsset::open(path, options);
  INFO((opened ? std::string() : opened.error().message));
  REQUIRE(opened.has_value());
  return std::move(*opened);
}

void check_same_words(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) {
  CHECK(std::vector(a.begin(), a.end()) == std::vector(b.begin(), b.end()));
}

/// Checks that the planes and the grid are those of an asset.
void check_same_frame(const Asset& asset, const AssetView& view) {
  REQUIRE(view.planes.size() == asset.planes.size());
  for (std::size_t k = 0; k < asset.planes.size(); ++k) {
    CHECK(view.planes[k].x0 == asset.planes[k].x0);
    CHECK(view.planes[k].u == asset.planes[k].u);
    CHECK(view.planes[k].v == asset.planes[k].v);
    CHECK(view.planes[k].n == asset.planes[k].n);
  }
  check_same_words(view.grid.index, asset.grid.index);
  check_same_words(view.grid.records, asset.grid.records);
  CHECK(view.grid.origin == asset.grid.origin);
  CHECK(view.grid.cell_size == asset.grid.cell_size);
  CHECK(view.grid.cells == asset.grid.cells);
}

void check_same_octree(const OctreeData& wanted, const AssetView& view) {
  CHECK(view.octree.origin == wanted.origin);
  CHECK(view.octree.edge == wanted.edge);
  CHECK(view.octree.roots == wanted.roots);
  CHECK(view.octree.clearance_unit == wanted.clearance_unit);
  CHECK(view.octree.reach == wanted.reach);
  check_same_words(view.octree.root_words, wanted.root_words);
  check_same_words(view.octree.words, wanted.words);
  check_same_words(view.octree.lists, wanted.lists);
  CHECK(view.exact.origin == wanted.lattice_origin);
  CHECK(view.exact.step == wanted.lattice_step);
  check_same_words(view.exact.corners, wanted.corners);
  check_same_words(view.exact.triangles, wanted.triangles);
  check_same_words(view.exact.sides, wanted.sides);
}

void check_same_content(const Asset& asset, const AssetView& view) {
  REQUIRE(view.maps.size() == asset.maps.size());
  for (std::size_t k = 0; k < asset.maps.size(); ++k) {
    const MapData& wanted = asset.maps[k];
    const DistanceMap& map = view.maps[k];
    REQUIRE(map.plane == wanted.plane);
    REQUIRE(map.layers == wanted.layers);
    REQUIRE(map.eta0 == wanted.eta0);
    REQUIRE(map.omega0 == wanted.omega0);
    REQUIRE(map.spacing == wanted.spacing);
    std::size_t at = 0;
    bool same = true;
    for (std::uint32_t layer = 0; layer < map.layers; ++layer) {
      for (std::uint32_t row = 0; row < map.rows; ++row) {
        for (std::uint32_t column = 0; column < map.columns; ++column) {
          same = same && map.at(layer, column, row) == wanted.samples[at++];
        }
      }
    }
    REQUIRE(same);
    check_same_words({map.mask, wanted.mask.size()}, wanted.mask);
  }
  check_same_frame(asset, view);
  if (!view.full) check_same_octree(asset.octree, view);
  CHECK(std::vector(view.triangles.begin(), view.triangles.end()) == asset.triangles);
  CHECK(view.band.max_depth == asset.metadata.band.max_depth);
  CHECK(view.band.margin == asset.metadata.band.margin);
  CHECK(view.full == (asset.metadata.form == AssetForm::full));
}

/// Equal, or both not a number.
bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

}  // namespace

TEST_CASE("A sparse asset reads back as it was written") {
  const TemporaryFolder folder;
  for (const std::uint32_t charts : {0U, 1U, 2U, 31U, 100U}) {
    const Asset asset = sparse_asset(charts, {.charts = charts, .triangles = charts % 3 * 7});
    const auto opened = written_and_opened(asset, folder.path("sparse.spm.exr"));
    check_same_content(asset, opened->view());
  }
}

TEST_CASE("A sparse asset of triangles alone reads back as it was written") {
  const TemporaryFolder folder;
  const Asset asset = sparse_asset(3, {.planes = 0, .triangles = 25});
  const auto opened = written_and_opened(asset, folder.path("triangles.spm.exr"));
  check_same_content(asset, opened->view());
  // Of each triangle three corners, here its own, their numbers and the sides.
  CHECK(opened->bytes().triangles == 25 * 3 * 8 + 25 * 8 + 26 * 2);
}

TEST_CASE("Each form has the parts of its own partition of space") {
  const TemporaryFolder folder;
  const auto names = [&folder](const Asset& asset) {
    const auto opened = written_and_opened(asset, folder.path("a.spm.exr"));
    std::vector<std::string> found;
    for (const PartInfo& part : opened->parts()) found.push_back(part.name);
    return found;
  };
  using Names = std::vector<std::string>;
  CHECK(names(sparse_asset(6)) == Names{"heights", "grid_roots", "grid_cubes", "grid_lists",
                                        "grid_maps", "triangles", "triangles_corners",
                                        "triangles_sides"});
  CHECK(names(full_asset(6, {2, 2})) ==
        Names{"heights02", "grid_index", "grid_records", "grid_masks", "triangles"});
  // What would be empty is left out: here all but the cubes.
  CHECK(names(sparse_asset(6, {.charts = 0, .triangles = 0})) == Names{"grid_roots", "grid_cubes"});
}

TEST_CASE("An open asset takes its file's bytes and the tables of its planes and maps") {
  const TemporaryFolder folder;
  const Asset asset = sparse_asset(9);
  const auto opened = written_and_opened(asset, folder.path("a.spm.exr"));
  CHECK(opened->resident_bytes() >= opened->bytes().total + 10 * sizeof(SupportPlane));
  CHECK(opened->resident_bytes() <= opened->bytes().total + 16 * sizeof(SupportPlane) +
                                        asset.atlas.charts.size() * sizeof(HeightChart) + 64);
}

TEST_CASE("A full asset reads back as it was written, for any numbers of layers") {
  const TemporaryFolder folder;
  for (const auto& layers :
       {std::vector<std::uint32_t>{1}, {255, 1}, many_layers, std::vector<std::uint32_t>(41, 11)}) {
    const Asset asset = full_asset(layers.size(), layers);
    const auto opened = written_and_opened(asset, folder.path("full.spm.exr"));
    check_same_content(asset, opened->view());
    CHECK(opened->view().plane_offset.size() == layers.size());
  }
}

TEST_CASE("The metadata of an asset reads back exactly") {
  const TemporaryFolder folder;
  const Asset asset = sparse_asset(5);
  const auto opened = written_and_opened(asset, folder.path("a.spm.exr"));
  const AssetMetadata& a = asset.metadata;
  const AssetMetadata& b = opened->metadata();
  CHECK(b.form == a.form);
  CHECK(b.kind == a.kind);
  CHECK(b.mesh_sha256 == a.mesh_sha256);
  CHECK(b.options == a.options);
  CHECK(b.mesh_unit == a.mesh_unit);
  CHECK(b.scale == a.scale);
  CHECK(b.diagonal == a.diagonal);
  CHECK(b.box_min == a.box_min);
  CHECK(b.box_max == a.box_max);
  CHECK(b.closed == a.closed);
  CHECK(b.border_edges == a.border_edges);
  CHECK(b.mesh_triangles == a.mesh_triangles);
  CHECK(b.probe_radius == a.probe_radius);
  CHECK(b.tolerance == a.tolerance);
  CHECK(b.tolerance_met == a.tolerance_met);
  CHECK(b.certified == a.certified);
  CHECK(b.layers_max == a.layers_max);
  CHECK(b.inconsistent_samples == a.inconsistent_samples);
  CHECK(b.tried_area == a.tried_area);
  CHECK(b.fallback_cells == a.fallback_cells);
}

TEST_CASE("An asset in memory and the same asset mapped answer alike") {
  const TemporaryFolder folder;
  for (const Asset& asset :
       {sparse_asset(11), sparse_asset(13, {.planes = 0}), full_asset(12, many_layers)}) {
    const auto opened = written_and_opened(asset, folder.path("a.spm.exr"));
    const AssetTables tables = tables_of(asset);
    Random random(3);
    int answered = 0;
    for (int k = 0; k < 20000; ++k) {
      const Vector3 point(random.between(-0.04, 0.04), random.between(-0.04, 0.04),
                          random.between(-0.03, 0.03));
      const Answer a = query_point(tables.view(), point);
      const Answer b = query_point(opened->view(), point);
      answered += a.status == Status::exact ? 1 : 0;
      REQUIRE((same(a.distance, b.distance) && same(a.normal.x(), b.normal.x()) &&
               same(a.normal.y(), b.normal.y()) && same(a.normal.z(), b.normal.z()) &&
               a.plane == b.plane && a.layer == b.layer && a.source == b.source &&
               a.status == b.status));
    }
    CHECK(answered > 0);
  }
}

TEST_CASE("The same asset gives the same bytes") {
  const TemporaryFolder folder;
  for (const Asset& asset : {sparse_asset(1), full_asset(2, many_layers)}) {
    REQUIRE(write_asset(asset, folder.path("one.spm.exr")).has_value());
    REQUIRE(write_asset(asset, folder.path("another-name.spm.exr")).has_value());
    const std::string bytes = read_bytes(folder.path("one.spm.exr"));
    CHECK(!bytes.empty());
    CHECK((bytes == read_bytes(folder.path("another-name.spm.exr"))));
  }
}

TEST_CASE("Every sample lies where the layout of an uncompressed tiled EXR puts it") {
  const TemporaryFolder folder;
  const Asset asset = full_asset(7, many_layers);
  const std::string path = folder.path("a.spm.exr");
  const auto opened = written_and_opened(asset, path);
  const std::string bytes = read_bytes(path);
  const HandFile file = read_by_hand(bytes);
  CHECK(file.header_bytes % 8 == 0);
  CHECK(file.parts[0].name() == "heights02");  // most maps have two layers

  std::vector<std::size_t> next_tile(13, 0);
  for (const MapData& map : asset.maps) {
    const auto part = std::find_if(file.parts.begin(), file.parts.end(), [&map](const HandPart& p) {
      return p.name() == heights_part_name(map.layers);
    });
    REQUIRE(part != file.parts.end());
    const std::size_t tile = next_tile[map.layers]++;
    bool same = true;
    std::size_t at = 0;
    for (std::uint32_t layer = 0; layer < map.layers; ++layer) {
      const std::string channel = layer == 0 ? "Y" : "hit" + std::to_string(layer) + ".Y";
      for (std::uint32_t row = 0; row < map.rows; ++row) {
        for (std::uint32_t column = 0; column < map.columns; ++column) {
          same = same && float_at(bytes, part->sample_offset(tile, channel, column, row)) ==
                             map.samples[at++];
        }
      }
    }
    CHECK(same);
  }
}

TEST_CASE("A sparse asset keeps the heights of its maps as one picture of metres") {
  const TemporaryFolder folder;
  Asset asset = sparse_asset(8);
  asset.atlas.halves = GENERATE(false, true);
  const std::string path = folder.path("a.spm.exr");
  const auto opened = written_and_opened(asset, path);
  const std::string bytes = read_bytes(path);
  const HandPart part = read_by_hand(bytes).parts.at(0);
  CHECK(part.name() == "heights");
  CHECK(part.sample_bytes == (asset.atlas.halves ? 2 : 4));
  CHECK(part.tile_width == asset.atlas.width);
  REQUIRE(part.table.size() == 1);
  std::vector<std::uint16_t> halves;
  for (const float height : asset.atlas.heights) halves.push_back(half_of(height));
  const auto stored = asset.atlas.halves ? std::as_bytes(std::span(halves))
                                         : std::as_bytes(std::span(asset.atlas.heights));
  CHECK(std::memcmp(bytes.data() + part.table[0] + 24, stored.data(), stored.size()) == 0);
  REQUIRE(opened->view().charts.size() == asset.atlas.charts.size());
  const AssetTables tables = tables_of(asset);
  for (std::size_t k = 0; k < asset.atlas.charts.size(); ++k) {
    const HeightChart &read = opened->view().charts[k], &known = tables.view().charts[k];
    CHECK(read.plane == known.plane);
    CHECK(read.offset == known.offset);
    CHECK(read.column.at({1, 2, 3}) == known.column.at({1, 2, 3}));
    CHECK(read.row.at({1, 2, 3}) == known.row.at({1, 2, 3}));
    CHECK(read.depth.at({1, 2, 3}) == known.depth.at({1, 2, 3}));
    CHECK(read.heights.at(1) == known.heights.at(1));
  }
}

TEST_CASE("Maps of the surface and of the offset surface read back each as what it is") {
  const TemporaryFolder folder;
  Asset asset = sparse_asset(8);
  asset.atlas.offset = -0.00123;
  std::vector<ChartData>& charts = asset.atlas.charts;
  for (std::size_t k = 0; k < charts.size(); ++k) charts[k].offset = k % 3 != 0;
  const std::string path = folder.path("a.spm.exr");
  const auto opened = written_and_opened(asset, path);
  REQUIRE(opened->view().charts.size() == charts.size());
  for (std::size_t k = 0; k < charts.size(); ++k) {
    CHECK(opened->view().charts[k].offset == (charts[k].offset ? -0.00123F : 0));
    CHECK(opened->view().charts[k].plane == charts[k].plane);
  }
  CHECK(read_bytes(path).find("\"offset\":-0.00123") != std::string::npos);
}

TEST_CASE("Bytes beside samples, grid and triangles stay below a tenth") {
  const TemporaryFolder folder;
  const std::string path = folder.path("a.spm.exr");
  const auto share = [&path](const Asset& asset) {
    const auto bytes = write_asset(asset, path);
    REQUIRE(bytes.has_value());
    CHECK(bytes->total == read_bytes(path).size());
    const auto useful = bytes->samples + bytes->grid + bytes->triangles;
    return 1 - static_cast<double>(useful) / static_cast<double>(bytes->total);
  };
  CHECK(share(sparse_asset(1, {.planes = 28, .charts = 1000, .triangles = 1000})) < 0.1);
  CHECK(share(sparse_asset(1, {.planes = 12, .charts = 200, .triangles = 1000})) < 0.1);
  CHECK(share(full_asset(1, std::vector<std::uint32_t>(100, 1), 33, 33)) < 0.1);
}

TEST_CASE("A mapped asset reports its parts, bytes and hash") {
  const TemporaryFolder folder;
  const std::string path = folder.path("a.spm.exr");
  const Asset asset = sparse_asset(4);
  const auto written = write_asset(asset, path);
  REQUIRE(written.has_value());
  const auto opened = MappedAsset::open(path, {.prefault = true, .lock = true});
  REQUIRE(opened.has_value());
  CHECK((*opened)->bytes().total == written->total);
  CHECK((*opened)->bytes().samples == written->samples);
  CHECK((*opened)->bytes().grid == written->grid);
  CHECK((*opened)->bytes().triangles ==
        4 * (asset.octree.corners.size() + asset.octree.triangles.size() +
             asset.octree.sides.size()));
  CHECK((*opened)->content_sha256() == sha256_file(path).value());
  CHECK((*opened)->parts().at(0).name == "heights");
  CHECK((*opened)->parts().at(0).channels == std::vector<std::string>{"Y"});
  CHECK((*opened)->path() == path);
}

}  // namespace round_trip_test
