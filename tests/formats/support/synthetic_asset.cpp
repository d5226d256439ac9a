// SPDX-License-Identifier: Apache-2.0
#include "tests/formats/support/synthetic_asset.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "common/base/octahedral.hpp"
#include "formats/exr/exr_header.hpp"
#include "formats/exr/exr_layout.hpp"
#include "formats/files/checksum.hpp"
#include "tests/formats/support/synthetic_octree.hpp"

namespace spm::test {

TemporaryFolder::TemporaryFolder(Place place) {
  const bool memory = place == Place::memory && std::filesystem::is_directory("/dev/shm");
  const std::filesystem::path root =
      memory ? std::filesystem::path("/dev/shm") : std::filesystem::temp_directory_path();
  std::string pattern = (root / "spm-test-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
  folder_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::vector<std::string> TemporaryFolder::entries() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

namespace {

SupportPlane random_plane(Random& random) {
  SupportPlane plane;
  plane.n =
      Vector3(random.between(-1, 1), random.between(-1, 1), random.between(0.1, 1)).normalized();
  plane.u = plane.n.unitOrthogonal();
  plane.v = plane.n.cross(plane.u);
  plane.x0 = 0.05 * plane.n;
  return plane;
}

AssetMetadata metadata_of(AssetForm form) {
  AssetMetadata metadata;
  metadata.form = form;
  metadata.kind = "face";
  metadata.mesh_sha256 = std::string(63, 'a') + "7";
  metadata.options = R"({"form":"x","seed":1})";
  metadata.mesh_unit = 0.001;
  metadata.scale = 0.1 / 3;
  metadata.diagonal = 0.1;
  metadata.box_min = Vector3(-0.03, -0.03, -0.02);
  metadata.box_max = Vector3(0.03, 0.03, 0.02);
  metadata.closed = true;
  metadata.border_edges = 3;
  metadata.mesh_triangles = 20000;
  metadata.band = {.max_depth = 0.002, .margin = 0.0005};
  if (form == AssetForm::sparse) metadata.tolerance = 1.0 / 30000;
  if (form == AssetForm::sparse) metadata.certified = 1.0 / 40000;
  metadata.tolerance_met = form == AssetForm::sparse;
  metadata.layers_max = 4;
  metadata.inconsistent_samples = 1.0 / 700;
  metadata.tried_area = 1.0 / 900;
  metadata.fallback_cells = 0.25;
  return metadata;
}

MapData random_map(Random& random, std::uint32_t columns, std::uint32_t rows,
                   std::uint32_t layers) {
  MapData map;
  map.columns = columns;
  map.rows = rows;
  map.layers = layers;
  map.spacing = random.between(0.001, 0.01);
  for (std::uint32_t k = 0; k < columns * rows * layers; ++k) {
    map.samples.push_back(static_cast<float>(random.between(0.03, 0.07)));
  }
  for (std::uint32_t k = 0; k < mask_words(columns, rows, layers); ++k) {
    map.mask.push_back(static_cast<std::uint32_t>(random.next() | random.next()));
  }
  return map;
}

/// Makes cells of every kind that name random maps and triangles.
class GridMaker {
 public:
  GridMaker(Random& random, const Asset& asset) : random_(random), asset_(asset) {
    grid.origin = Vector3(-0.035, -0.035, -0.025);
    grid.cell_size = 0.01;
    grid.cells = {7, 7, 5};
    for (std::uint32_t cell = 0; cell < 7 * 7 * 5; ++cell) {
      grid.index.push_back(cell % 9 == 8 ? split(3) : word(cell % 7));
    }
  }

  GridData grid;

 private:
  static std::uint32_t word_of(CellKind kind, std::uint32_t payload) {
    return static_cast<std::uint32_t>(kind) << 30U | payload;
  }

  std::uint32_t word(std::uint32_t kind) {
    if (kind == 0) return word_of(CellKind::far, 0);
    if (kind == 1) return word_of(CellKind::deep, pack_octahedral(Vector3(0.6, 0, 0.8)));
    if (kind == 2) return word_of(CellKind::pruned, 0);
    if (kind == 3 && !lists_.empty()) {
      return lists_[below(random_, static_cast<std::uint32_t>(lists_.size()))];
    }
    lists_.push_back(list());
    return lists_.back();
  }

  std::uint32_t list() {
    const auto triangles = static_cast<std::uint32_t>(asset_.triangles.size() / 9);
    const std::uint32_t map_count = 1 + below(random_, 4);
    const std::uint32_t triangle_count = below(random_, 4);
    const auto offset = static_cast<std::uint32_t>(grid.records.size());
    grid.records.push_back(list_header(map_count, triangle_count));
    for (std::uint32_t k = 0; k < map_count; ++k) {
      const std::uint32_t map = below(random_, static_cast<std::uint32_t>(asset_.maps.size()));
      grid.records.push_back(pack_candidate({map, below(random_, asset_.maps[map].layers)}));
    }
    for (std::uint32_t k = 0; k < triangle_count; ++k) {
      grid.records.push_back(below(random_, triangles) * 2 + below(random_, 2));
    }
    return word_of(CellKind::record, offset);
  }

  /// A split cell, whose first octant is split again until `levels` splits are nested.
  std::uint32_t split(int levels) {
    std::vector<std::uint32_t> octants;
    if (levels > 1) octants.push_back(split(levels - 1));
    while (octants.size() < 8) octants.push_back(word(below(random_, 7)));
    const auto offset = static_cast<std::uint32_t>(grid.records.size());
    grid.records.insert(grid.records.end(), octants.begin(), octants.end());
    return word_of(CellKind::record, split_bit | offset);
  }

  Random& random_;
  const Asset& asset_;
  std::vector<std::uint32_t> lists_;
};

std::vector<float> random_triangles(Random& random, std::uint32_t count) {
  std::vector<float> corners;
  for (std::uint32_t k = 0; k < 9 * count; ++k) {
    corners.push_back(static_cast<float>(random.between(-0.03, 0.03)));
  }
  return corners;
}

}  // namespace

Asset sparse_asset(std::uint64_t seed, const SparseShape& shape) {
  Random random(seed);
  Asset asset;
  asset.metadata = metadata_of(AssetForm::sparse);
  for (std::uint32_t k = 0; k < shape.planes; ++k) asset.planes.push_back(random_plane(random));
  asset.atlas = random_atlas(random, shape.planes, shape.charts);
  asset.octree =
      random_octree(random, static_cast<std::uint32_t>(asset.atlas.charts.size()), shape.triangles);
  round_to_stored(asset);
  return asset;
}

Asset full_asset(std::uint64_t seed, const std::vector<std::uint32_t>& layers,
                 std::uint32_t columns, std::uint32_t rows) {
  Random random(seed);
  Asset asset;
  asset.metadata = metadata_of(AssetForm::full);
  for (std::uint32_t plane = 0; plane < layers.size(); ++plane) {
    asset.planes.push_back(random_plane(random));
    MapData map = random_map(random, columns, rows, layers[plane]);
    map.plane = plane;
    for (float& sample : map.samples) {
      if (below(random, 4) == 0) sample = no_hit;
    }
    asset.maps.push_back(std::move(map));
  }
  asset.triangles = random_triangles(random, 5);
  asset.grid = GridMaker(random, asset).grid;
  round_to_stored(asset);
  return asset;
}

std::string read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void write_bytes(const std::string& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

void reseal(std::string& bytes) {
  const auto view = std::as_bytes(std::span(bytes.data(), bytes.size()));
  if (const auto place = find_string_attribute(view, attribute_name::bytes);
      place && place->size == bytes_decimals) {
    std::string decimals = std::to_string(bytes.size());
    decimals.insert(0, bytes_decimals - decimals.size(), '0');
    bytes.replace(place->offset, decimals.size(), decimals);
  }
  if (const auto place = find_string_attribute(view, attribute_name::checksum);
      place && place->size == checksum_digits) {
    bytes.replace(place->offset, checksum_digits,
                  checksum_text(file_checksum(view, place->offset)));
  }
}

}  // namespace spm::test
