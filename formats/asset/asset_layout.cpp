// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/asset_layout.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "formats/asset/chart_words.hpp"

namespace spm {
namespace {

/// The parts of a file by name, read in place.
class Parts {
 public:
  Parts(std::span<const std::byte> bytes, const std::vector<ExrPart>& parts)
      : bytes_(bytes), parts_(parts) {}

  [[nodiscard]] const ExrPart* find(std::string_view name) const {
    const auto found = std::find_if(parts_.begin(), parts_.end(),
                                    [name](const ExrPart& part) { return part.name == name; });
    return found == parts_.end() ? nullptr : &*found;
  }

  [[nodiscard]] const std::byte* at(std::uint64_t offset) const { return bytes_.data() + offset; }
  [[nodiscard]] const std::vector<ExrPart>& all() const { return parts_; }

  /// The first `count` words of a part that is a single tile; nothing where the part is not as
  /// required. Where `count` is 0 the part must be missing.
  template <class T>
  [[nodiscard]] std::optional<std::span<const T>> words(std::string_view name,
                                                        std::uint64_t count) const {
    const ExrPart* part = find(name);
    if (count == 0) return part == nullptr ? std::optional(std::span<const T>()) : std::nullopt;
    const SampleType type = std::is_same_v<T, float> ? SampleType::float32 : SampleType::uint32;
    if (part == nullptr || part->type != type || part->channels != stored_channels(1) ||
        part->offsets.size() != 1 || part->tile_samples() < count ||
        part->tile_samples() - count >= part->tile_width) {
      return std::nullopt;
    }
    return std::span(reinterpret_cast<const T*>(at(part->offsets.front())), count);
  }

 private:
  std::span<const std::byte> bytes_;
  const std::vector<ExrPart>& parts_;
};

tl::unexpected<Error> refuse(const std::string& path, const std::string& cause) {
  return fail(ExitCode::invalid_input, path + ": " + cause + "; bake it again");
}

tl::unexpected<Error> wrong_part(const std::string& path, std::string_view name) {
  return refuse(path, "part " + std::string(name) + " is missing or not as the asset describes it");
}

/// Maps, and the tables that they point to beside their samples.
struct Maps {
  std::vector<DistanceMap> maps;
  std::vector<std::vector<std::uint32_t>> layer_offsets;
};

const float* floats_at(const Parts& parts, std::uint64_t offset) {
  return reinterpret_cast<const float*>(parts.at(offset));
}

/// A tile of a `full` asset: the start of its samples, and its number of layers.
struct FullTile {
  std::uint64_t offset = 0;
  std::uint32_t layers = 0;
};

Result<std::vector<FullTile>> full_tiles(const Parts& parts, const AssetDescription& description,
                                         const std::string& path) {
  std::vector<FullTile> tiles;
  for (const ExrPart& part : parts.all()) {
    if (!part.name.starts_with(part_name::heights)) continue;
    const auto layers = static_cast<std::uint32_t>(part.channels.size());
    if (layers > 255 || part.name != heights_part_name(layers) ||
        part.channels != stored_channels(layers) || part.type != SampleType::float32 ||
        part.tile_width != description.map_columns || part.tile_height != description.map_rows) {
      return wrong_part(path, part.name);
    }
    for (const std::uint64_t offset : part.offsets) tiles.push_back({offset, layers});
  }
  return tiles;
}

Result<Maps> full_maps(const Parts& parts, const AssetDescription& description,
                       const std::string& path) {
  const Result<std::vector<FullTile>> tiles = full_tiles(parts, description, path);
  if (!tiles) return tl::make_unexpected(tiles.error());
  Maps result;
  for (const FullTile& tile : *tiles) {
    for (auto layers = static_cast<std::uint32_t>(result.layer_offsets.size()) + 1;
         layers <= tile.layers; ++layers) {
      result.layer_offsets.push_back(stored_layer_offsets(layers, description.map_columns));
    }
  }
  std::vector<bool> used(tiles->size(), false);
  std::uint64_t mask_count = 0;
  for (std::uint32_t plane = 0; plane < description.planes.size(); ++plane) {
    const std::uint32_t tile = description.plane_tile[plane];
    if (tile >= tiles->size() || used[tile]) {
      return refuse(path, "tile " + std::to_string(tile) + " of plane " + std::to_string(plane) +
                              " does not exist or belongs to two planes");
    }
    used[tile] = true;
    const FullTile& found = (*tiles)[tile];
    DistanceMap map;
    map.samples = floats_at(parts, found.offset);
    map.layer_offsets = result.layer_offsets[found.layers - 1].data();
    map.plane = plane;
    map.columns = description.map_columns;
    map.rows = description.map_rows;
    map.layers = found.layers;
    map.row_stride = found.layers * map.columns;
    map.spacing = description.plane_spacing[plane];
    mask_count += mask_words(map.columns, map.rows, map.layers);
    result.maps.push_back(map);
  }
  const auto masks = parts.words<std::uint32_t>(part_name::grid_masks, mask_count);
  if (!masks) return wrong_part(path, part_name::grid_masks);
  const std::uint32_t* mask = masks->data();
  for (DistanceMap& map : result.maps) {
    map.mask = std::exchange(mask, mask + mask_words(map.columns, map.rows, map.layers));
  }
  return result;
}

/// The distance maps of a `sparse` asset, and the heights of all of them.
struct AtlasRead {
  std::vector<HeightChart> charts;
  StoredHeights heights;
};

Result<AtlasRead> sparse_maps(const Parts& parts, const AssetDescription& description,
                              const std::string& path) {
  AtlasRead read;
  const std::uint64_t count = description.atlas_charts;
  const auto words = parts.words<std::uint32_t>(part_name::grid_maps, count * chart_word_count);
  if (!words) return wrong_part(path, part_name::grid_maps);
  const ExrPart* picture = parts.find(part_name::heights);
  if (count == 0) {
    if (picture != nullptr) return wrong_part(path, part_name::heights);
    return read;
  }
  if (picture == nullptr || picture->type == SampleType::uint32 ||
      picture->channels != stored_channels(1) || picture->offsets.size() != 1 ||
      picture->tile_width != description.atlas.width) {
    return wrong_part(path, part_name::heights);
  }
  const std::size_t heights = std::size_t{picture->tile_width} * picture->tile_height;
  const std::uint64_t start = picture->offsets.front();
  if (picture->type == SampleType::half16) {
    read.heights = std::span(reinterpret_cast<const std::uint16_t*>(parts.at(start)), heights);
  } else {
    read.heights = std::span(floats_at(parts, start), heights);
  }
  read.charts.reserve(count);
  for (const ChartData& chart : read_charts(*words)) {
    const std::string problem = chart_problem(chart, description.planes.size(),
                                              description.atlas.width, read.heights.count);
    if (!problem.empty()) {
      return refuse(path, "distance map " + std::to_string(read.charts.size()) + " " + problem);
    }
    read.charts.push_back(
        chart_over(chart, description.planes[chart.plane], description.atlas, read.heights));
  }
  return read;
}

/// The grid and triangles of a `full` asset; returns the name of a part that is not as required, if
/// any.
std::string_view find_grid(const Parts& parts, const AssetDescription& description,
                           AssetView& view) {
  const auto& cells = description.grid_cells;
  const auto index = parts.words<std::uint32_t>(part_name::grid_index,
                                                std::uint64_t{cells[0]} * cells[1] * cells[2]);
  if (!index) return part_name::grid_index;
  const auto records =
      parts.words<std::uint32_t>(part_name::grid_records, description.grid_records);
  if (!records) return part_name::grid_records;
  const auto corners =
      parts.words<float>(part_name::triangles, std::uint64_t{9} * description.triangles);
  if (!corners) return part_name::triangles;
  view.grid = {.origin = description.grid_origin,
               .cell_size = description.grid_cell_size,
               .cells = cells,
               .index = *index,
               .records = *records};
  view.triangles = *corners;
  return {};
}

/// The octree and the exact triangles of a `sparse` asset, likewise.
std::string_view find_octree(const Parts& parts, const AssetDescription& description,
                             AssetView& view) {
  const OctreeData& data = description.octree;
  const auto roots = parts.words<std::uint32_t>(
      part_name::grid_roots, std::uint64_t{data.roots[0]} * data.roots[1] * data.roots[2]);
  if (!roots) return part_name::grid_roots;
  const auto words = parts.words<std::uint32_t>(part_name::grid_cubes, description.octree_words);
  if (!words) return part_name::grid_cubes;
  const auto lists = parts.words<std::uint32_t>(part_name::grid_lists, description.octree_lists);
  if (!lists) return part_name::grid_lists;
  const auto triangles =
      parts.words<std::uint32_t>(part_name::triangles, 2 * description.exact_triangles);
  if (!triangles) return part_name::triangles;
  const auto corners =
      parts.words<std::uint32_t>(part_name::triangles_corners, 2 * description.exact_corners);
  if (!corners) return part_name::triangles_corners;
  const auto sides =
      parts.words<std::uint32_t>(part_name::triangles_sides, (description.exact_triangles + 1) / 2);
  if (!sides) return part_name::triangles_sides;
  data.add_to(view);
  view.octree.root_words = *roots;
  view.octree.words = *words;
  view.octree.lists = *lists;
  view.exact.triangles = *triangles;
  view.exact.corners = *corners;
  view.exact.sides = *sides;
  return {};
}

/// Parts that no asset of this form has.
const ExrPart* unexpected_part(const Parts& parts, bool full) {
  for (const ExrPart& part : parts.all()) {
    const std::string& name = part.name;
    const bool common = name == part_name::triangles;
    const bool own = full ? name.starts_with(part_name::heights) || name == part_name::grid_masks ||
                                name == part_name::grid_index || name == part_name::grid_records
                          : name == part_name::heights || name == part_name::grid_maps ||
                                name == part_name::grid_roots || name == part_name::grid_cubes ||
                                name == part_name::grid_lists ||
                                name == part_name::triangles_corners ||
                                name == part_name::triangles_sides;
    if (!common && !own) return &part;
  }
  return nullptr;
}

}  // namespace

Result<AssetTables> lay_out(std::span<const std::byte> bytes, const std::vector<ExrPart>& exr_parts,
                            const AssetDescription& description, const std::string& path) {
  const Parts parts(bytes, exr_parts);
  const bool full = description.metadata.form == AssetForm::full;
  if (const ExrPart* part = unexpected_part(parts, full)) return wrong_part(path, part->name);
  Result<Maps> maps = full ? full_maps(parts, description, path) : Result<Maps>();
  if (!maps) return tl::make_unexpected(std::move(maps.error()));
  Result<AtlasRead> atlas = full ? Result<AtlasRead>() : sparse_maps(parts, description, path);
  if (!atlas) return tl::make_unexpected(std::move(atlas.error()));
  AssetView rest;
  rest.atlas = atlas->heights;
  const std::string_view wrong =
      full ? find_grid(parts, description, rest) : find_octree(parts, description, rest);
  if (!wrong.empty()) return wrong_part(path, wrong);
  description.metadata.add_to(rest);
  return AssetTables(description.planes, std::move(maps->maps), std::move(maps->layer_offsets),
                     std::move(atlas->charts), rest);
}

}  // namespace spm
