// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/pipeline/bake.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "baker/base/bake_error.hpp"
#include "baker/base/stopwatch.hpp"
#include "baker/cast/cast.hpp"
#include "baker/full/full.hpp"
#include "baker/full/map_filter.hpp"
#include "baker/full/partition.hpp"
#include "baker/pipeline/sparse.hpp"
#include "baker/planes/hull.hpp"
#include "baker/smooth/smooth.hpp"
#include "baker/surface/outer_surface.hpp"
#include "common/base/octant.hpp"

namespace spm::baker {

namespace {

/// Share of the diagonal that is the tolerance where none was given.
constexpr double default_tolerance_share = 1e-3;
/// Height samples, over all planes and before layers, that a `full` asset may have: 2 GB of floats.
constexpr double max_samples = 5e8;
/// Gaps narrower than this share of the tolerance are closed: rounding to the lattice would.
constexpr double narrow_gap_share = 0.02;
/// The error that the partition of a `full` asset aims at, as a share of the diagonal. It promises
/// nothing.
constexpr double full_aim_share = 5e-4;

void check_options(const BakeOptions& options, double margin, double sheet_thickness) {
  const auto refuse = [](const std::string& message) { throw BakeError(ExitCode::usage, message); };
  if (!(options.max_depth > 0)) refuse("--max-depth must be more than 0");
  if (!(options.probe_radius >= 0)) refuse("--probe must have a radius of 0 or more");
  if (!(margin >= options.probe_radius)) {
    refuse("--margin must be at least the probe's radius, or the probe would touch unfelt");
  }
  if (options.tolerance && !(*options.tolerance > 0)) refuse("--tolerance must be more than 0");
  if (!(sheet_thickness <= options.max_depth)) {
    refuse("--sheet-thickness must be at most --max-depth");
  }
  if (options.resolution < 2 || options.resolution > 4097) {
    refuse("--resolution must be from 2 to 4097 samples");
  }
  if (options.layers == Layers::limited && (options.layer_limit < 1 || options.layer_limit > 255)) {
    refuse("--layers must be auto, scalar or a number from 1 to 255");
  }
}

std::string options_json(const Mesh& mesh, const BakeOptions& options,
                         const AssetMetadata& metadata) {
  nlohmann::ordered_json json;
  json["form"] = options.form == AssetForm::full ? "full" : "sparse";
  json["max_depth"] = metadata.band.max_depth;
  json["margin"] = metadata.band.margin;
  json["probe_radius"] = metadata.probe_radius;
  json["unit"] = metadata.mesh_unit;
  json["scale"] = metadata.scale;
  json["seed"] = options.seed;
  if (options.smooth.kind != Smoothing::none) {
    json["smooth"] = smoothing_json(fitted_to(options.smooth, metadata.diagonal));
  }
  if (options.workspace) json["workspace"] = to_json(*options.workspace);
  if (metadata.sheet_thickness > 0) json["sheet_thickness"] = metadata.sheet_thickness;
  if (mesh.open_as != OpenAs::automatic) {
    json["open"] = open_as_words[static_cast<std::size_t>(mesh.open_as)];
  }
  if (options.form == AssetForm::full) {
    json["kind"] = metadata.kind;
    json["planes"] =
        options.planes ? nlohmann::ordered_json(*options.planes) : nlohmann::ordered_json();
    json["resolution"] = options.resolution;
    if (options.smooth_maps.kind != Smoothing::none) {
      json["smooth_maps"] = smoothing_json(fitted_to(options.smooth_maps, metadata.diagonal));
    }
    json["layers"] =
        options.layers == Layers::automatic
            ? nlohmann::ordered_json("auto")
            : nlohmann::ordered_json(options.layers == Layers::scalar ? 1 : options.layer_limit);
  } else {
    json["tolerance"] = *metadata.tolerance;
    json["direction_tolerance"] = options.direction_tolerance;
    if (options.max_bytes) json["max_bytes"] = *options.max_bytes;
  }
  return json.dump();
}

AssetMetadata describe(const Mesh& mesh, const BakeOptions& options) {
  AssetMetadata metadata;
  metadata.form = options.form;
  metadata.mesh_sha256 = mesh.sha256;
  metadata.mesh_unit = mesh.unit;
  metadata.scale = mesh.scale;
  metadata.diagonal = mesh.diagonal;
  metadata.box_min = mesh.box_min;
  metadata.box_max = mesh.box_max;
  metadata.closed = mesh.closed();
  metadata.border_edges = mesh.border_edges;
  metadata.mesh_triangles = mesh.file_triangles;
  metadata.probe_radius = options.probe_radius;
  metadata.band.max_depth = options.max_depth;
  metadata.band.margin = options.margin.value_or(options.probe_radius + options.max_depth / 4);
  if (options.form == AssetForm::sparse) {
    metadata.tolerance = options.tolerance.value_or(default_tolerance_share * mesh.diagonal);
  }
  if (!mesh.closed()) {
    metadata.sheet_thickness =
        options.sheet_thickness.value_or(std::min(answer_tolerance(metadata), options.max_depth));
  }
  return metadata;
}

/// Points whose hull encloses a surface and what is felt of its sheets.
std::vector<Vector3> felt_points(const Mesh& mesh, double sheet_thickness) {
  if (sheet_thickness == 0) return mesh.vertices;
  std::vector<Vector3> points;
  for (const Vector3& vertex : mesh.vertices) {
    for (std::size_t octant = 0; octant < 8; ++octant) {
      points.push_back(vertex + sheet_thickness * octant_direction(octant));
    }
  }
  return points;
}

/// Support planes and maps of the `full` form, and their partition.
void bake_full(BakeResult& result, const Caster& caster, const Hull& hull,
               const BakeOptions& options, const Progress& progress, CastCounts& counts) {
  Asset& asset = result.asset;
  SupportPlaneSet set = make_support_planes(hull, options.kind, options.planes);
  const double samples =
      static_cast<double>(set.planes.size()) * options.resolution * options.resolution;
  if (samples > max_samples) {
    throw BakeError(ExitCode::usage,
                    std::to_string(set.planes.size()) + " planes of " +
                        std::to_string(options.resolution) + " x " +
                        std::to_string(options.resolution) +
                        " samples are more than 500 million; ask for fewer --planes or a smaller "
                        "--resolution");
  }
  asset.planes = std::move(set.planes);
  asset.metadata.kind = set.kind == PlaneKind::vertex ? "vertex" : "face";
  const Clock::time_point casting = Clock::now();
  asset.maps = cast_full_maps(caster, asset.planes, options, progress, counts);
  result.report.seconds_cast = seconds_since(casting);
  result.report.stages.end("maps");
  const Clock::time_point partitioning = Clock::now();
  const PartitionCounts partition =
      partition_space(asset, caster, full_aim_share * asset.metadata.diagonal, progress);
  result.report.seconds_fit += seconds_since(partitioning);
  result.report.stages.end("partition");
  // Behind the partition, which tries maps against the surface.
  if (options.smooth_maps.kind != Smoothing::none) {
    filter_maps(asset.maps, fitted_to(options.smooth_maps, asset.metadata.diagonal));
    result.report.stages.end("smooth_maps");
  }
  for (const MapData& map : asset.maps) result.report.samples += map.samples.size();
  result.report.record_cells = partition.records;
  result.report.fallback_cells = partition.fallback;
}

void add_notes(const Mesh& mesh, const OuterSurface& surface, const CastCounts& counts,
               BakeReport& report) {
  report.notes.insert(report.notes.begin(), mesh.notes.begin(), mesh.notes.end());
  if (surface.hidden > 0) {
    report.notes.push_back(std::to_string(surface.hidden) +
                           " pieces of surface lie inside other parts and were left out");
  }
  if (surface.intersecting.count > 0) {
    MeshFinding& finding = report.found_in_surface.emplace_back();
    finding = {
        FindingKind::selfintersecting, surface.intersecting.count,
        fmt::format("{} triangles cross others, and were cut there.", surface.intersecting.count),
        mesh.vertices[surface.intersecting.vertex]};
    report.notes.push_back(finding.what);
  }
  if (counts.inconsistent > 0) {
    report.notes.push_back(
        std::to_string(counts.inconsistent) + " of " + std::to_string(counts.rays) +
        " rays met entries and exits that do not alternate; their samples are marked");
  }
}

/// What the parts of the mesh were taken for, and what was found in it.
std::string solid_json(const Mesh& mesh, const BakeReport& report) {
  nlohmann::ordered_json json = {
      {"parts", mesh.components}, {"sheets", mesh.sheets},
      {"lids", mesh.lids.size()}, {"welded", mesh.welded},
      {"copies", mesh.copies},    {"found", nlohmann::ordered_json::array()}};
  for (const auto* findings : {&mesh.findings, &report.found_in_surface}) {
    for (const MeshFinding& finding : *findings) {
      json["found"].push_back(
          {{"kind", finding_words[static_cast<std::size_t>(finding.kind)]},
           {"count", finding.count},
           {"what", finding.what},
           {"place_m", {finding.place.x(), finding.place.y(), finding.place.z()}}});
    }
  }
  return json.dump();
}

}  // namespace

BakeResult bake(const Mesh& mesh, const BakeOptions& options, const Progress& progress) {
  const unsigned threads = options.threads > 0
                               ? options.threads
                               : static_cast<unsigned>(tbb::info::default_concurrency());
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  BakeResult result;
  Asset& asset = result.asset;
  asset.metadata = describe(mesh, options);
  check_options(options, asset.metadata.band.margin, asset.metadata.sheet_thickness);

  const Clock::time_point start = Clock::now();
  if (options.smooth.kind != Smoothing::none) {
    SmoothReport& smooth = result.report.smooth.emplace();
    result.smoothed = smoothed_mesh(mesh, options.smooth, progress, smooth);
  }
  const Mesh& solid = result.smoothed ? *result.smoothed : mesh;
  if (result.report.smooth) result.report.stages.end("smooth");
  if (progress) progress("surface", 0);
  OuterSurface surface = outer_surface(solid, narrow_gap_share * answer_tolerance(asset.metadata));
  if (result.report.smooth) surface.hidden += result.report.smooth->hidden;
  if (surface.triangles.empty()) {
    throw BakeError(ExitCode::invalid_input,
                    mesh.path +
                        ": no part of its surface separates an inside from an outside; turn the "
                        "triangles outward, or bake it with --open sheet");
  }
  result.report.stages.end("surface");
  const std::vector<Vector3> points = felt_points(solid, asset.metadata.sheet_thickness);
  const Hull hull =
      options.form == AssetForm::full ? convex_hull(points) : convex_hull_vertices(points);
  result.report.stages.end("hull");
  const Caster caster(surface, asset.metadata.sheet_thickness);
  result.report.stages.end("caster");
  result.report.seconds_fit = seconds_since(start);

  CastCounts counts;
  if (options.form == AssetForm::full) {
    bake_full(result, caster, hull, options, progress, counts);
  } else {
    bake_sparse(result, surface, caster, hull, options, progress, counts);
  }
  result.report.lids = mesh.lids;
  add_notes(solid, surface, counts, result.report);
  asset.metadata.solid = solid_json(mesh, result.report);
  asset.metadata.layers_max = counts.layers_max;
  asset.metadata.inconsistent_samples =
      counts.rays > 0 ? static_cast<double>(counts.inconsistent) / static_cast<double>(counts.rays)
                      : 0;
  asset.metadata.fallback_cells = result.report.record_cells > 0
                                      ? static_cast<double>(result.report.fallback_cells) /
                                            static_cast<double>(result.report.record_cells)
                                      : 0;
  asset.metadata.options = options_json(mesh, options, asset.metadata);
  return result;
}

}  // namespace spm::baker
