// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/asset_json.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "formats/files/json_fields.hpp"
#include "formats/files/json_text.hpp"

namespace spm {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t max_maps = 1U << 24U;  // limit of a grid record
constexpr std::uint32_t max_charts = max_named_maps;
constexpr std::uint32_t max_samples_a_side = 1U << 14U;
constexpr std::uint32_t max_cells_an_axis = 1U << 20U;
constexpr std::uint64_t max_cells = std::uint64_t{1} << 30U;
constexpr std::uint64_t max_words = std::uint64_t{1} << 28U;  // limit of a grid word
constexpr std::uint64_t max_corners = std::uint64_t{1} << corner_bits;
constexpr std::uint64_t max_triangles = std::uint64_t{1} << 30U;
constexpr double min_length = 1e-20;  // stays a normal float over all levels and heights
constexpr double any_factor = std::numeric_limits<double>::max();
constexpr double basis_slack = 1e-6;

Json json_of(const Vector3& vector) { return Json::array({vector.x(), vector.y(), vector.z()}); }

Json mesh_json(const AssetMetadata& metadata) {
  return {{"unit", metadata.mesh_unit},
          {"scale", metadata.scale},
          {"diagonal", metadata.diagonal},
          {"box_min", json_of(metadata.box_min)},
          {"box_max", json_of(metadata.box_max)},
          {"closed", metadata.closed},
          {"border_edges", metadata.border_edges},
          {"triangles", metadata.mesh_triangles}};
}

Json planes_json(const AssetDescription& description) {
  Json rows = Json::array();
  for (std::size_t index = 0; index < description.planes.size(); ++index) {
    const SupportPlane& plane = description.planes[index];
    Json row = {{"x0", json_of(plane.x0)},
                {"u", json_of(plane.u)},
                {"v", json_of(plane.v)},
                {"n", json_of(plane.n)}};
    if (description.metadata.form == AssetForm::full) {
      row["spacing"] = description.plane_spacing[index];
      row["tile"] = description.plane_tile[index];
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

Json grid_json(const AssetDescription& description) {
  return {{"origin", json_of(description.grid_origin)},
          {"cell_size", description.grid_cell_size},
          {"cells", description.grid_cells},
          {"records", description.grid_records}};
}

Json octree_json(const AssetDescription& description) {
  const OctreeData& octree = description.octree;
  return {{"origin", json_of(octree.origin)},
          {"edge", octree.edge},
          {"roots", octree.roots},
          {"words", description.octree_words},
          {"lists", description.octree_lists},
          {"clearance_unit", octree.clearance_unit},
          {"reach", octree.reach},
          {"beyond_share", octree.beyond_share}};
}

Json exact_json(const AssetDescription& description) {
  return {{"triangles", description.exact_triangles},
          {"corners", description.exact_corners},
          {"origin", json_of(description.octree.lattice_origin)},
          {"step", description.octree.lattice_step}};
}

/// Adds the number of maps of the asset's form, and the layout of their samples.
void add_surfaces(const AssetDescription& description, Json& json) {
  const AssetMetadata& metadata = description.metadata;
  if (metadata.form == AssetForm::full) {
    json["maps"] = {{"count", description.maps},
                    {"columns", description.map_columns},
                    {"rows", description.map_rows}};
  } else {
    json["atlas"] = {{"charts", description.atlas_charts},
                     {"width", description.atlas.width},
                     {"spacing", description.atlas.spacing},
                     {"offset", description.atlas.offset}};
  }
  if (metadata.form == AssetForm::full) json["triangles"] = description.triangles;
}

bool is_sha256(const std::string& text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

/// Whether what was found is there as `info` prints it.
bool is_solid(const Json& solid) {
  if (!solid.is_object()) return false;
  if (!solid.contains("found")) return true;
  const Json& found = solid["found"];
  return found.is_array() && std::all_of(found.begin(), found.end(), [](const Json& one) {
           if (!one.is_object() || !one.contains("what") || !one.contains("place_m")) return false;
           const Json& place = one["place_m"];
           return one["what"].is_string() && place.is_array() && place.size() == 3 &&
                  std::all_of(place.begin(), place.end(),
                              [](const Json& x) { return x.is_number(); });
         });
}

bool is_basis(const SupportPlane& plane) {
  Eigen::Matrix3d basis;
  basis << plane.u, plane.v, plane.n;
  return (basis.transpose() * basis - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <=
             basis_slack &&
         basis.determinant() > 0;
}

AssetMetadata read_metadata(JsonFields& fields) {
  AssetMetadata metadata;
  const std::string form = fields.text("form");
  if (form != "sparse" && form != "full") fields.wrong("form", "\"sparse\" or \"full\"");
  metadata.form = form == "full" ? AssetForm::full : AssetForm::sparse;
  if (fields.text("units") != "m") fields.wrong("units", "\"m\"");
  metadata.kind = fields.text("kind");
  metadata.mesh_sha256 = fields.text("mesh_sha256");
  if (!is_sha256(metadata.mesh_sha256)) fields.wrong("mesh_sha256", "64 hex digits");
  const Json& options = fields.optional("options");
  if (!options.is_object()) fields.wrong("options", "an object");
  metadata.options = options.dump();
  if (metadata.form == AssetForm::full) {
    if (!fields.optional("tolerance").is_null()) fields.wrong("tolerance", "null in the full form");
  } else if (const double tolerance = fields.number("tolerance", 0); tolerance > 0) {
    metadata.tolerance = tolerance;
  } else {
    fields.wrong("tolerance", "a length above 0");
  }
  metadata.tolerance_met = fields.flag("tolerance_met");
  if (!fields.optional("certified").is_null()) metadata.certified = fields.number("certified", 0);
  if (metadata.certified && metadata.form == AssetForm::full) {
    fields.wrong("certified", "null in the full form");
  }
  JsonFields band = fields.child("band");
  metadata.band = {.max_depth = band.number("max_depth", 0), .margin = band.number("margin", 0)};
  metadata.probe_radius = fields.child("probe").number("radius", 0);
  metadata.layers_max = static_cast<std::uint32_t>(fields.integer("layers_max", 0, UINT32_MAX));
  metadata.inconsistent_samples = fields.number("inconsistent_samples", 0, 1);
  metadata.tried_area = fields.number("tried_area", 0, 1);
  metadata.fallback_cells = fields.number("fallback_cells", 0, 1);
  metadata.sheet_thickness = fields.number("sheet_thickness", 0);
  const Json& solid = fields.optional("solid");
  if (!is_solid(solid)) fields.wrong("solid", "an object whose `found` has places");
  metadata.solid = solid.dump();
  return metadata;
}

void read_mesh(JsonFields mesh, AssetMetadata& metadata) {
  metadata.mesh_unit = mesh.number("unit", min_length);
  metadata.scale = mesh.number("scale", 0, any_factor);
  if (metadata.scale <= 0) mesh.wrong("scale", "a factor above 0");
  metadata.diagonal = mesh.number("diagonal", 0);
  metadata.box_min = mesh.vector("box_min");
  metadata.box_max = mesh.vector("box_max");
  if ((metadata.box_max - metadata.box_min).minCoeff() < 0) {
    mesh.wrong("box_max", "at or above `mesh.box_min`");
  }
  metadata.closed = mesh.flag("closed");
  metadata.border_edges = mesh.integer("border_edges", 0, UINT64_MAX);
  metadata.mesh_triangles = mesh.integer("triangles", 0, UINT64_MAX);
}

void read_grid(JsonFields grid, AssetDescription& description) {
  description.grid_origin = grid.vector("origin");
  description.grid_cell_size = grid.number("cell_size", min_length);
  description.grid_cells = grid.triple("cells", 1, max_cells_an_axis);
  const auto& cells = description.grid_cells;
  if (std::uint64_t{cells[0]} * cells[1] > max_cells ||
      std::uint64_t{cells[0]} * cells[1] * cells[2] > max_cells) {
    grid.wrong("cells", "a grid of at most 2^30 cells");
  }
  description.grid_records = grid.integer("records", 0, max_words);
}

void read_octree(JsonFields& fields, AssetDescription& description) {
  OctreeData& data = description.octree;
  JsonFields octree = fields.child("octree");
  data.origin = octree.vector("origin");
  data.edge = octree.number("edge", min_length);
  data.roots = octree.triple("roots", 1, max_cells_an_axis);
  if (std::uint64_t{data.roots[0]} * data.roots[1] > max_cells ||
      std::uint64_t{data.roots[0]} * data.roots[1] * data.roots[2] > max_cells) {
    octree.wrong("roots", "a grid of at most 2^30 cubes");
  }
  description.octree_words = octree.integer("words", 0, max_words);
  description.octree_lists = octree.integer("lists", 0, max_words);
  data.clearance_unit = octree.number("clearance_unit", min_length);
  data.reach = octree.number("reach", min_length);
  // Assets of earlier programs promise nothing.
  if (!octree.optional("beyond_share").is_null()) {
    data.beyond_share = octree.number("beyond_share", 0, 1);
  }
  JsonFields exact = fields.child("exact");
  description.exact_triangles = exact.integer("triangles", 0, max_triangles);
  description.exact_corners = exact.integer("corners", 0, max_corners);
  data.lattice_origin = exact.vector("origin");
  data.lattice_step = exact.number("step", min_length);
}

void read_maps(JsonFields maps, AssetDescription& description) {
  const auto integer = [&maps](const char* key, std::uint64_t low, std::uint64_t high) {
    return static_cast<std::uint32_t>(maps.integer(key, low, high));
  };
  description.maps = integer("count", 1, max_maps);
  description.map_columns = integer("columns", 2, max_samples_a_side);
  description.map_rows = integer("rows", 2, max_samples_a_side);
}

void read_atlas(JsonFields atlas, AssetDescription& description) {
  description.atlas_charts = static_cast<std::uint32_t>(atlas.integer("charts", 0, max_charts));
  const bool none = description.atlas_charts == 0;
  description.atlas.width = static_cast<std::uint32_t>(
      atlas.integer("width", none ? 0 : 4, none ? 0 : max_samples_a_side));
  description.atlas.spacing = atlas.number("spacing", none ? 0 : min_length);
  description.atlas.offset = atlas.number("offset", -JsonFields::greatest, 0);
}

void read_planes(JsonFields& fields, AssetDescription& description, std::string& problem) {
  const Json& rows = fields.array("planes");
  for (std::size_t index = 0; index < rows.size() && problem.empty(); ++index) {
    JsonFields row(rows[index], "planes[" + std::to_string(index) + "].", problem);
    SupportPlane plane;
    plane.x0 = row.vector("x0");
    plane.u = row.vector("u");
    plane.v = row.vector("v");
    plane.n = row.vector("n");
    if (!is_basis(plane)) row.wrong("n", "of unit length and u x v");
    description.planes.push_back(plane);
    if (description.metadata.form == AssetForm::full) {
      description.plane_spacing.push_back(row.number("spacing", min_length));
      description.plane_tile.push_back(
          static_cast<std::uint32_t>(row.integer("tile", 0, UINT32_MAX)));
    }
  }
  if (description.metadata.form == AssetForm::full && problem.empty() &&
      (description.planes.empty() || description.planes.size() != description.maps)) {
    fields.wrong("planes", "a table of one row a map, as the full form has it");
  }
}

}  // namespace

AssetDescription describe(const Asset& asset) {
  AssetDescription description;
  description.metadata = asset.metadata;
  description.planes = asset.planes;
  if (asset.metadata.form == AssetForm::full) {
    for (const MapData& map : asset.maps) description.plane_spacing.push_back(map.spacing);
  }
  description.plane_tile.resize(description.plane_spacing.size(), 0);
  description.grid_origin = asset.grid.origin;
  description.grid_cell_size = asset.grid.cell_size;
  description.grid_cells = asset.grid.cells;
  description.grid_records = asset.grid.records.size();
  const OctreeData& octree = asset.octree;
  description.octree = {.origin = octree.origin,
                        .edge = octree.edge,
                        .roots = octree.roots,
                        .clearance_unit = octree.clearance_unit,
                        .reach = octree.reach,
                        .beyond_share = octree.beyond_share,
                        .root_words = {},
                        .words = {},
                        .lists = {},
                        .lattice_origin = octree.lattice_origin,
                        .lattice_step = octree.lattice_step,
                        .corners = {},
                        .triangles = {},
                        .sides = {}};
  description.octree_words = octree.words.size();
  description.octree_lists = octree.lists.size();
  description.exact_triangles = octree.triangles.size() / 2;
  description.exact_corners = octree.corners.size() / 2;
  description.maps = static_cast<std::uint32_t>(asset.maps.size());
  if (!asset.maps.empty()) {
    description.map_columns = asset.maps.front().columns;
    description.map_rows = asset.maps.front().rows;
  }
  if (!asset.atlas.charts.empty()) {
    description.atlas.spacing = asset.atlas.spacing;
    description.atlas.offset = asset.atlas.offset;
    description.atlas.width = asset.atlas.width;
  }
  description.atlas_charts = static_cast<std::uint32_t>(asset.atlas.charts.size());
  description.triangles = static_cast<std::uint32_t>(asset.triangles.size() / 9);
  return description;
}

std::string to_json(const AssetDescription& description) {
  const AssetMetadata& metadata = description.metadata;
  Json json = {{"format_version", asset_format_version},
               {"form", metadata.form == AssetForm::full ? "full" : "sparse"},
               {"units", "m"},
               {"kind", metadata.kind},
               {"mesh_sha256", metadata.mesh_sha256},
               {"options", Json::parse(metadata.options)},
               {"tolerance", metadata.tolerance ? Json(*metadata.tolerance) : Json()},
               {"tolerance_met", metadata.tolerance_met},
               {"certified", metadata.certified ? Json(*metadata.certified) : Json()},
               {"band", {{"max_depth", metadata.band.max_depth}, {"margin", metadata.band.margin}}},
               {"probe", Json::object({{"radius", metadata.probe_radius}})},
               {"layers_max", metadata.layers_max},
               {"inconsistent_samples", metadata.inconsistent_samples},
               {"tried_area", metadata.tried_area},
               {"fallback_cells", metadata.fallback_cells},
               {"sheet_thickness", metadata.sheet_thickness},
               {"solid", Json::parse(metadata.solid)},
               {"mesh", mesh_json(metadata)}};
  if (metadata.form == AssetForm::full) {
    json["grid"] = grid_json(description);
  } else {
    json["octree"] = octree_json(description);
    json["exact"] = exact_json(description);
  }
  add_surfaces(description, json);
  json["planes"] = planes_json(description);
  return json.dump();
}

Result<AssetDescription> parse_description(std::string_view text, const std::string& place) {
  const auto refuse = [&place](const std::string& cause) {
    return fail(ExitCode::invalid_input, place + ": " + cause + "; bake it again");
  };
  const Json json = parse_json<Json>(text);
  if (!json.is_object())
    return refuse("its `spm` attribute is not a JSON object of at most " +
                  std::to_string(most_json_levels) + " levels");
  std::string problem;
  JsonFields fields(json, "", problem);
  const std::uint64_t version = fields.integer("format_version", 0, UINT32_MAX);
  if (problem.empty() && version != asset_format_version) {
    return refuse("format version " + std::to_string(version) + ", this program reads " +
                  std::to_string(asset_format_version) +
                  (version < asset_format_version
                       ? "; an older spm-bake wrote it"
                       : "; a newer spm-bake wrote it, update this one"));
  }
  AssetDescription description;
  description.metadata = read_metadata(fields);
  read_mesh(fields.child("mesh"), description.metadata);
  if (description.metadata.form == AssetForm::full) {
    description.triangles =
        static_cast<std::uint32_t>(fields.integer("triangles", 0, max_triangles));
    read_grid(fields.child("grid"), description);
    read_maps(fields.child("maps"), description);
  } else {
    read_octree(fields, description);
    read_atlas(fields.child("atlas"), description);
  }
  read_planes(fields, description, problem);
  if (!problem.empty()) return refuse("in its `spm` attribute " + problem);
  return description;
}

}  // namespace spm
