// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/asset_writer.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "formats/asset/asset.hpp"
#include "formats/asset/asset_json.hpp"
#include "formats/asset/chart_words.hpp"
#include "formats/exr/exr_writer.hpp"
#include "formats/files/host.hpp"
#include "formats/files/json_text.hpp"

namespace spm {
namespace {

/// A flat array as one EXR tile, so that it is contiguous in the file.
template <class T>
PartPlan flat_part(std::string_view name, SampleType type, std::span<const T> values) {
  static_assert(sizeof(T) == 4);
  PartPlan part;
  part.name = name;
  part.type = type;
  part.channels = {"Y"};
  const TileGrid picture = arrange_words(values.size());
  part.tile_width = picture.columns;
  part.tile_height = picture.rows;
  part.tiles = {1, 1};
  part.payload = [values, bytes = part.tile_bytes()](std::uint32_t,
                                                     std::vector<std::byte>& scratch) {
    const std::span<const std::byte> whole = std::as_bytes(values);
    if (whole.size() == bytes) return whole;
    scratch.assign(bytes, std::byte{0});
    std::copy(whole.begin(), whole.end(), scratch.begin());
    return std::span<const std::byte>(scratch);
  };
  return part;
}

void fill(std::vector<std::byte>& scratch, std::uint64_t bytes, float value) {
  scratch.resize(bytes);
  for (std::uint64_t at = 0; at < bytes; at += sizeof value) {
    std::memcpy(scratch.data() + at, &value, sizeof value);
  }
}

/// Copies a map's layers, which are stored one behind the other in memory, into a tile's
/// interleaved rows.
void interleave(const MapData& map, std::span<const std::uint32_t> layer_offsets,
                std::vector<std::byte>& tile) {
  for (std::uint32_t layer = 0; layer < map.layers; ++layer) {
    for (std::uint32_t row = 0; row < map.rows; ++row) {
      const std::size_t from = (std::size_t{layer} * map.rows + row) * map.columns;
      const std::size_t to = std::size_t{row} * map.layers * map.columns + layer_offsets[layer];
      std::memcpy(tile.data() + to * sizeof(float), map.samples.data() + from,
                  map.columns * sizeof(float));
    }
  }
}

PartPlan full_part(const Asset& asset, std::uint32_t layers, std::vector<std::uint32_t> members) {
  const MapData& first = asset.maps[members.front()];
  PartPlan part;
  part.name = heights_part_name(layers);
  part.channels = stored_channels(layers);
  part.tile_width = first.columns;
  part.tile_height = first.rows;
  part.tiles = arrange_tiles(static_cast<std::uint32_t>(members.size()), first.columns, first.rows);
  part.payload = [&asset, members = std::move(members), bytes = part.tile_bytes(),
                  offsets = stored_layer_offsets(layers, first.columns)](
                     std::uint32_t tile, std::vector<std::byte>& scratch) {
    fill(scratch, bytes, no_hit);
    if (tile < members.size()) interleave(asset.maps[members[tile]], offsets, scratch);
    return std::span<const std::byte>(scratch);
  };
  return part;
}

/// Parts for the maps of a `full` asset, one for each number of layers. The one with most maps
/// comes first, because viewers open that. Sets the tile of every plane.
std::vector<PartPlan> full_parts(const Asset& asset, std::vector<std::uint32_t>& plane_tile) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> groups;
  for (std::uint32_t index = 0; index < asset.maps.size(); ++index) {
    groups[asset.maps[index].layers].push_back(index);
  }
  std::vector<std::pair<std::uint32_t, std::vector<std::uint32_t>>> ordered(groups.begin(),
                                                                            groups.end());
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const auto& a, const auto& b) { return a.second.size() > b.second.size(); });
  std::vector<PartPlan> parts;
  std::uint32_t first_tile = 0;
  for (auto& [layers, members] : ordered) {
    for (std::uint32_t k = 0; k < members.size(); ++k) plane_tile[members[k]] = first_tile + k;
    parts.push_back(full_part(asset, layers, std::move(members)));
    first_tile += parts.back().tiles.columns * parts.back().tiles.rows;
  }
  return parts;
}

/// The heights of a `sparse` asset's distance maps, as one picture.
PartPlan atlas_part(const Asset& asset) {
  PartPlan part;
  part.name = part_name::heights;
  part.channels = stored_channels(1);
  part.tile_width = asset.atlas.width;
  part.tile_height = static_cast<std::uint32_t>(asset.atlas.heights.size() / asset.atlas.width);
  part.tiles = {1, 1};
  part.type = asset.atlas.halves ? SampleType::half16 : SampleType::float32;
  part.payload = [&asset](std::uint32_t, std::vector<std::byte>& made) {
    const std::span<const float> heights(asset.atlas.heights);
    if (!asset.atlas.halves) return std::as_bytes(heights);
    made.resize(heights.size() * sizeof(std::uint16_t));
    for (std::size_t i = 0; i < heights.size(); ++i) {
      const std::uint16_t half = heights[i] < least_half ? std::uint16_t{0} : half_of(heights[i]);
      std::memcpy(made.data() + i * sizeof half, &half, sizeof half);
    }
    return std::span<const std::byte>(made);
  };
  return part;
}

/// The error in the distance maps of a `sparse` asset; empty where there is none.
std::string atlas_problem(const Asset& asset) {
  const AtlasData& atlas = asset.atlas;
  if (atlas.charts.empty() != atlas.heights.empty()) return "its maps and heights do not agree";
  if (atlas.charts.empty()) return {};
  if (atlas.width == 0 || atlas.heights.size() % atlas.width != 0 || !(atlas.spacing > 0)) {
    return "its maps have no spacing or no shape";
  }
  for (std::size_t index = 0; index < atlas.charts.size(); ++index) {
    const std::string problem =
        chart_problem(atlas.charts[index], asset.planes.size(), atlas.width, atlas.heights.size());
    if (!problem.empty()) return "its map " + std::to_string(index) + " " + problem;
  }
  return {};
}

/// The error in the maps of a `full` asset; empty where there is none.
std::string map_problem(const Asset& asset) {
  if (asset.maps.empty() || asset.maps.size() != asset.planes.size()) {
    return "it has not one map a plane";
  }
  const MapData& first = asset.maps.front();
  for (std::size_t index = 0; index < asset.maps.size(); ++index) {
    const MapData& map = asset.maps[index];
    const std::size_t samples = std::size_t{map.layers} * map.columns * map.rows;
    const bool shape = map.columns == first.columns && map.rows == first.rows && map.columns >= 2 &&
                       map.rows >= 2 && map.layers >= 1 && map.layers <= 255 &&
                       map.samples.size() == samples &&
                       map.mask.size() == mask_words(map.columns, map.rows, map.layers);
    const bool place = map.plane == index && map.eta0 == 0 && map.omega0 == 0;
    if (!shape || !place) return "its map " + std::to_string(index) + " is inconsistent";
  }
  return {};
}

/// The error in an asset that the writer received; empty where there is none.
std::string inconsistency(const Asset& asset) {
  const bool full = asset.metadata.form == AssetForm::full;
  const auto options = parse_json<nlohmann::json>(asset.metadata.options);
  if (!options.is_object()) return "its options are not a JSON object";
  const GridData& grid = asset.grid;
  if (full && (grid.index.empty() ||
               grid.index.size() != std::size_t{grid.cells[0]} * grid.cells[1] * grid.cells[2])) {
    return "its grid has not one word a cell";
  }
  if (grid.records.size() > offset_mask) return "its grid has more words than can be named";
  const OctreeData& octree = asset.octree;
  const std::size_t roots = std::size_t{octree.roots[0]} * octree.roots[1] * octree.roots[2];
  if (octree.root_words.size() != roots || (roots == 0) != full || octree.corners.size() % 2 != 0 ||
      octree.triangles.size() % 2 != 0 ||
      octree.sides.size() != (octree.triangles.size() / 2 + 1) / 2) {
    return "its octree is not of whole cubes and triangles, or of the other form";
  }
  if (full && !(octree.words.empty() && octree.lists.empty() && octree.corners.empty() &&
                octree.triangles.empty())) {
    return "it holds parts of an octree, which belongs to the other form";
  }
  if (!full && !(grid.index.empty() && grid.records.empty())) {
    return "it holds a grid, which belongs to the other form";
  }
  if (asset.triangles.size() % 9 != 0 || (!full && !asset.triangles.empty())) {
    return "its triangles are not of nine numbers, or of the other form";
  }
  if (full ? !asset.atlas.charts.empty() : !asset.maps.empty()) {
    return "it holds what belongs to the other form";
  }
  return full ? map_problem(asset) : atlas_problem(asset);
}

std::vector<Attribute> attributes_of(const AssetDescription& description) {
  const AssetMetadata& metadata = description.metadata;
  std::vector<Attribute> attributes = {
      {"spm_format_version", asset_format_version}, {"spm_units", std::string("m")},
      {"spm_mesh_sha256", metadata.mesh_sha256},    {"spm_max_depth", metadata.band.max_depth},
      {"spm_margin", metadata.band.margin},         {"spm_probe_radius", metadata.probe_radius},
  };
  if (metadata.tolerance) attributes.emplace_back("spm_tolerance", *metadata.tolerance);
  attributes.emplace_back(attribute_name::description, to_json(description));
  return attributes;
}

std::uint64_t payload_of(const std::vector<PartPlan>& parts, std::string_view prefix) {
  std::uint64_t bytes = 0;
  for (const PartPlan& part : parts) {
    if (part.name.starts_with(prefix)) bytes += part.payload_bytes();
  }
  return bytes;
}

}  // namespace

Result<AssetBytes> write_asset(const Asset& asset, const std::string& path) {
  if (auto good = check_host(path); !good) return tl::make_unexpected(std::move(good.error()));
  if (const std::string cause = inconsistency(asset); !cause.empty()) {
    return fail(ExitCode::internal,
                path + ": the baked asset cannot be written: " + cause + "; report this");
  }
  AssetDescription description = describe(asset);
  std::vector<PartPlan> parts;
  if (description.metadata.form == AssetForm::full) {
    parts = full_parts(asset, description.plane_tile);
  } else {
    // Viewers open the first.
    if (!asset.atlas.charts.empty()) parts.push_back(atlas_part(asset));
  }
  const std::vector<std::uint32_t> charts = words_of(asset.atlas.charts);
  std::vector<std::uint32_t> masks;
  for (const MapData& map : asset.maps) masks.insert(masks.end(), map.mask.begin(), map.mask.end());
  const auto add = [&parts](std::string_view name, SampleType type, const auto& values) {
    if (!values.empty()) parts.push_back(flat_part(name, type, std::span(values)));
  };
  add(part_name::grid_index, SampleType::uint32, asset.grid.index);
  add(part_name::grid_records, SampleType::uint32, asset.grid.records);
  add(part_name::grid_roots, SampleType::uint32, asset.octree.root_words);
  add(part_name::grid_cubes, SampleType::uint32, asset.octree.words);
  add(part_name::grid_lists, SampleType::uint32, asset.octree.lists);
  add(part_name::grid_maps, SampleType::uint32, charts);
  add(part_name::grid_masks, SampleType::uint32, masks);
  add(part_name::triangles, SampleType::float32, asset.triangles);
  add(part_name::triangles, SampleType::uint32, asset.octree.triangles);
  add(part_name::triangles_corners, SampleType::uint32, asset.octree.corners);
  add(part_name::triangles_sides, SampleType::uint32, asset.octree.sides);

  Result<OutputFile> file = OutputFile::create(path);
  if (!file) return tl::make_unexpected(std::move(file.error()));
  const Result<std::uint64_t> total = write_exr(*file, path, parts, attributes_of(description));
  if (!total) return tl::make_unexpected(total.error());
  if (auto done = file->commit(); !done) return tl::make_unexpected(std::move(done.error()));
  return AssetBytes{.total = *total,
                    .samples = payload_of(parts, part_name::heights),
                    .grid = payload_of(parts, "grid"),
                    .triangles = payload_of(parts, part_name::triangles)};
}

std::uint64_t bytes_without_octree(const Asset& asset) {
  // Of parts that are not there yet: header, table and chunk of each, and words that fill its
  // picture up.
  constexpr std::uint64_t octree_parts = 6, part_bytes = 512;
  constexpr std::uint64_t description_bytes = 2560, plane_bytes = 320;
  return octree_parts * part_bytes + description_bytes + plane_bytes * asset.planes.size();
}

Result<void> check_output_path(const std::string& path) {
  // Creating the temporary file is the only check that is right on every file system.
  Result<OutputFile> file = OutputFile::create(path);
  if (!file) return tl::make_unexpected(std::move(file.error()));
  return {};
}

}  // namespace spm
