// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "baker/base/bake_error.hpp"
#include "baker/build/build.hpp"
#include "baker/commands/commands.hpp"
#include "baker/commands/info_json.hpp"
#include "baker/pictures/picture.hpp"
#include "baker/pictures/picture_files.hpp"
#include "baker/pictures/picture_legend.hpp"
#include "baker/pictures/picture_text.hpp"
#include "common/asset/grid_list.hpp"
#include "common/field/octree_leaves.hpp"
#include "formats/asset/asset_writer.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "formats/cli/command_line.hpp"

namespace spm::baker {
namespace {

/// Calls `visit` with the list of an index word, or with the lists of the octants of a split cell.
/// Splits that do not lie within the records are skipped.
template <class Visit>
void visit_lists(const Grid& grid, std::uint32_t word, const Visit& visit, int level = 0) {
  if (static_cast<CellKind>(word >> 30U) != CellKind::record) return;
  if (!is_split(word)) {
    visit(GridList(grid, word));
    return;
  }
  const std::size_t offset = word & offset_mask;
  if (level >= split_levels || offset + 8 > grid.records.size()) return;
  for (const std::uint32_t octant : grid.records.subspan(offset, 8)) {
    visit_lists(grid, octant, visit, level + 1);
  }
}

using Json = nlohmann::ordered_json;

constexpr std::uint32_t picture_side = 512;
constexpr std::uint32_t thumbnail_side = 160;
constexpr std::size_t max_thumbnails = 100;
constexpr double background = 40.0 / 255;  ///< grey of pictures where there is nothing

struct InfoSettings {
  std::string asset;
  std::string pictures;
  std::size_t picture_limit = 16;
  cli::GlobalOptions global;
};

/// Planes that have maps, by index.
std::vector<std::size_t> planes_with_maps(const AssetView& view) {
  std::vector<std::size_t> planes;
  for (const DistanceMap& map : view.maps) planes.push_back(map.plane);
  for (const HeightChart& chart : view.charts) planes.push_back(chart.plane);
  std::sort(planes.begin(), planes.end());
  planes.erase(std::unique(planes.begin(), planes.end()), planes.end());
  return planes;
}

Legend legend_of(const AssetView& view, std::size_t plane, const PlaneRelief& relief) {
  const Vector3& n = view.planes[plane].n;
  return {
      fmt::format("Support plane {}, seen along its normal ({:.2f} {:.2f} {:.2f}): u to the "
                  "right, v upward; the crossing nearest to the plane.",
                  plane, n.x(), n.y(), n.z()),
      ColourBar{"far: " + length_text(relief.farthest),
                length_text((relief.nearest + relief.farthest) / 2), length_text(relief.nearest)},
      {{Colour{background, background, background}, "no map of this plane answers"}},
      relief.pixel};
}

/// Writes an overview and the first planes' pictures; returns their paths.
std::vector<std::string> write_pictures(const AssetView& view, const InfoSettings& settings) {
  const std::filesystem::path folder = make_picture_folder(settings.pictures);
  const std::vector<std::size_t> planes = planes_with_maps(view);
  std::vector<Picture> thumbnails;
  for (std::size_t i = 0; i < std::min(planes.size(), max_thumbnails); ++i) {
    thumbnails.push_back(plane_picture(view, planes[i], thumbnail_side));
  }
  std::vector<std::string> paths;
  if (!thumbnails.empty()) {
    const Legend legend{fmt::format("The maps of {} of {} support planes, in rows from the upper "
                                    "left; each seen along its normal, with colours of its own: "
                                    "bright is near the plane, dark is far.",
                                    thumbnails.size(), planes.size()),
                        {},
                        {},
                        0};
    paths.push_back(save_picture(with_legend(contact_sheet(thumbnails, thumbnail_side), legend),
                                 folder / "overview.png"));
  }
  for (std::size_t i = 0; i < std::min(planes.size(), settings.picture_limit); ++i) {
    const PlaneRelief relief = plane_relief(view, planes[i], picture_side);
    paths.push_back(save_picture(with_legend(relief.picture, legend_of(view, planes[i], relief)),
                                 folder / fmt::format("plane-{:04}.png", planes[i])));
  }
  return paths;
}

Json vector_json(const Vector3& v) { return Json::array({v.x(), v.y(), v.z()}); }

Json parts_json(const MappedAsset& asset) {
  Json parts = Json::array();
  for (const PartInfo& part : asset.parts()) {
    parts.push_back({{"name", part.name},
                     {"width", part.width},
                     {"height", part.height},
                     {"tile", {part.tile_width, part.tile_height}},
                     {"channels", part.channels},
                     {"bytes", part.payload_bytes}});
  }
  return parts;
}

std::uint64_t samples_of(const AssetView& view) {
  std::uint64_t samples = view.atlas.count;
  for (const DistanceMap& map : view.maps) {
    samples += std::uint64_t{map.columns} * map.rows * map.layers;
  }
  return samples;
}

/// The leaves of an octree that answer: how many there are of each kind.
struct LeafKinds {
  std::uint64_t maps = 0, map_pairs = 0, lists = 0;
  [[nodiscard]] std::uint64_t all() const noexcept { return maps + map_pairs + lists; }
};

LeafKinds kinds_of(const DistanceOctree& octree) {
  LeafKinds kinds;
  visit_leaves(octree, [&](const Leaf& leaf) {
    const std::uint32_t* words = words_at(octree, leaf);
    if (leaf.kind == OctreeKind::map && words != nullptr) {
      ++(NamedMaps(words[0]).two() ? kinds.map_pairs : kinds.maps);
    }
    if (leaf.kind == OctreeKind::list) ++kinds.lists;
  });
  return kinds;
}

/// Cells of the grid of a `full` asset that touch the band, and octants of split ones.
std::uint64_t band_cells(const Grid& grid) {
  std::uint64_t cells = 0;
  for (const std::uint32_t word : grid.index) {
    visit_lists(grid, word, [&cells](const GridList&) { ++cells; });
  }
  return cells;
}

/// The cubes of the octree and the triangles that answers come from.
Json octree_json(const AssetView& view, const LeafKinds& kinds) {
  return {{"origin_m", vector_json(view.octree.origin)},
          {"root_edge_m", view.octree.edge},
          {"roots", view.octree.roots},
          {"maps", kinds.maps},
          {"pairs_of_maps", kinds.map_pairs},
          {"lists", kinds.lists},
          {"triangles", view.exact.size()}};
}

}  // namespace

nlohmann::ordered_json to_json(const MappedAsset& asset, const std::vector<std::string>& pictures) {
  const AssetMetadata& metadata = asset.metadata();
  const AssetView& view = asset.view();
  const AssetBytes bytes = asset.bytes();
  const LeafKinds kinds = view.full ? LeafKinds{} : kinds_of(view.octree);
  Json json;
  json["path"] = asset.path();
  json["bytes"] = bytes.total;
  json["content_sha256"] = asset.content_sha256();
  json["format_version"] = asset_format_version;
  json["spm"] = {{"form", metadata.form == AssetForm::full ? "full" : "sparse"},
                 {"kind", metadata.kind},
                 {"planes", view.planes.size()},
                 {"tiles", view.maps.size() + view.charts.size()},
                 {"samples", samples_of(view)},
                 {"layers_max", metadata.layers_max},
                 {"cells", view.full ? band_cells(view.grid) : kinds.all()}};
  json["band"] = {{"max_depth_m", view.band.max_depth}, {"margin_m", view.band.margin}};
  json["probe_radius_m"] = metadata.probe_radius;
  json["tolerance_um"] = metadata.tolerance ? Json(*metadata.tolerance * 1e6) : Json();
  json["tolerance_met"] = metadata.tolerance_met;
  json["certified_um"] = metadata.certified ? Json(*metadata.certified * 1e6) : Json();
  json["mesh"] = {
      {"sha256", metadata.mesh_sha256},
      {"triangles", metadata.mesh_triangles},
      {"closed", metadata.closed},
      {"border_edges", metadata.border_edges},
      {"diagonal_m", metadata.diagonal},
      {"bbox_m", {{"min", vector_json(metadata.box_min)}, {"max", vector_json(metadata.box_max)}}},
      {"unit_m", metadata.mesh_unit},
      {"scale", metadata.scale}};
  json["solid"] = Json::parse(metadata.solid, nullptr, false);
  if (view.full) {
    json["grid"] = {{"origin_m", vector_json(view.grid.origin)},
                    {"cell_m", view.grid.cell_size},
                    {"cells", view.grid.cells}};
  } else {
    json["octree"] = octree_json(view, kinds);
    add_answers(view, json);
  }
  json["fallback"] = {
      {"cells", metadata.fallback_cells},
      {"bytes", static_cast<double>(bytes.triangles) / static_cast<double>(bytes.total)}};
  json["inconsistent_samples"] = metadata.inconsistent_samples;
  json["tried_area"] = metadata.tried_area;
  json["bytes_by_kind"] = {{"samples", bytes.samples},
                           {"grid", bytes.grid},
                           {"triangles", bytes.triangles},
                           {"other", bytes.total - bytes.samples - bytes.grid - bytes.triangles}};
  json["parts"] = parts_json(asset);
  json["options"] = Json::parse(metadata.options, nullptr, false);
  json["pictures"] = pictures;
  return json;
}

namespace {

std::string length(double metres) { return format_quantity(metres, Quantity::length); }

/// The proven error and what is only tried, as the end of a line.
std::string certified(const AssetMetadata& metadata) {
  if (!metadata.certified) return {};
  std::string text = fmt::format("; proven largest error {}", length(*metadata.certified));
  if (metadata.tried_area > 0) {
    text += fmt::format(", but sides are only tried beside {:.2g} % of the surface",
                        100 * metadata.tried_area);
  }
  return text + "; directions are tried";
}

/// What was found in the mesh, and where.
std::string found_text(const Json& found) {
  const auto millimetres = [&found](std::size_t axis) {
    return 1e3 * found["place_m"][axis].get<double>();
  };
  return fmt::format("found     {} One at ({:.6g}, {:.6g}, {:.6g}) mm.\n",
                     found["what"].get<std::string>(), millimetres(0), millimetres(1),
                     millimetres(2));
}

std::string describe(const MappedAsset& asset, const std::vector<std::string>& pictures) {
  const AssetMetadata& metadata = asset.metadata();
  const AssetView& view = asset.view();
  const AssetBytes bytes = asset.bytes();
  std::string text = fmt::format("{}: intact, {} bytes, format version {}\n", asset.path(),
                                 bytes.total, asset_format_version);
  text += fmt::format("form      {}: {} {}-based support planes, {} {}, {} samples\n",
                      view.full ? "full" : "sparse", view.planes.size(), metadata.kind,
                      view.maps.size() + view.charts.size(), "distance maps", samples_of(view));
  if (!view.full) {
    Json answers;
    add_answers(view, answers);
    text += "answers   " + answers_text(answers) + "\n";
  }
  text += fmt::format("layers    up to {} crossings along a ray\n", metadata.layers_max);
  text += fmt::format(
      "band      {} inside, {} outside, probe {}\n", length(view.band.max_depth),
      length(view.band.margin),
      metadata.probe_radius > 0 ? "of radius " + length(metadata.probe_radius) : "point");
  text += metadata.tolerance
              ? fmt::format("tolerance {}, {}{}\n", length(*metadata.tolerance),
                            metadata.tolerance_met ? "met" : "NOT met", certified(metadata))
              : std::string("tolerance none: a full asset promises none\n");
  text += fmt::format(
      "mesh      {} triangles, {}, diagonal {}, scale {}, SHA-256 {}\n", metadata.mesh_triangles,
      metadata.closed ? std::string("closed")
                      : fmt::format("open ({} border edges)", metadata.border_edges),
      length(metadata.diagonal), metadata.scale, metadata.mesh_sha256);
  const Json solid = Json::parse(metadata.solid, nullptr, false);
  for (const Json& found : solid.value("found", Json::array())) text += found_text(found);
  text += fmt::format("bytes     samples {}, grid {}, triangles {}, other {}\n", bytes.samples,
                      bytes.grid, bytes.triangles,
                      bytes.total - bytes.samples - bytes.grid - bytes.triangles);
  for (const PartInfo& part : asset.parts()) {
    text += fmt::format("part      {}: {} x {}, {} channels, {} bytes\n", part.name, part.width,
                        part.height, part.channels.size(), part.payload_bytes);
  }
  for (const std::string& picture : pictures) text += "picture   " + picture + "\n";
  return text;
}

int run(const InfoSettings& settings) {
  cli::configure_messages(settings.global);
  const auto asset = MappedAsset::open(settings.asset);
  if (!asset) return cli::report(asset.error());
  std::vector<std::string> pictures;
  if (!settings.pictures.empty()) pictures = write_pictures((*asset)->view(), settings);
  if (settings.global.json) {
    cli::print_json(to_json(**asset, pictures));
  } else if (!settings.global.quiet) {
    std::cout << describe(**asset, pictures);
  }
  return 0;
}

}  // namespace

Command add_info_command(CLI::App& app) {
  auto settings = std::make_shared<InfoSettings>();
  CLI::App* command =
      app.add_subcommand("info", "Checks a baked file, every byte, and tells what is in it");
  command->add_option("FILE", settings->asset, "baked file")->required()->type_name("");
  command->add_option("--png", settings->pictures, "write the maps as pictures into this folder")
      ->type_name("DIR");
  cli::add_integer(
      *command, "--png-limit", 1, 100000,
      [settings = settings.get()](std::uint64_t n) { settings->picture_limit = n; },
      "planes that get a picture of their own, 1 to 100000 (default 16)");
  cli::add_global_options(*command, settings->global);
  return {command, [settings] { return run(*settings); }};
}

}  // namespace spm::baker
