// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/pipeline/sparse.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "baker/base/bake_error.hpp"
#include "baker/base/stopwatch.hpp"
#include "baker/charts/chart_heights.hpp"
#include "baker/charts/plane_charts.hpp"
#include "baker/field/octree_build.hpp"
#include "baker/pipeline/surface_tiles.hpp"
#include "baker/planes/planes.hpp"
#include "baker/reachability/reachability.hpp"
#include "baker/tiles/tile_fit.hpp"
#include "baker/trials/served_trials.hpp"
#include "common/surface/distance_map.hpp"
#include "formats/asset/asset_writer.hpp"

namespace spm::baker {

namespace {

/// Of tiles and polynomials, and of the distance maps that answer.
constexpr std::size_t directions = 8, map_directions = 20;
/// The coarsest spacing of these maps, of the diagonal, and how often it is halved.
constexpr double map_spacing_share = 1.0 / 64;
constexpr std::uint32_t map_levels = 2;
/// How far maps go on over what other planes see better, in depths of the band and spacings.
constexpr double reach_depths = 1, reach_spacings = 2;
/// Tolerances below this share of the diagonal are not proven, since the rounding of queries is no
/// longer small.
constexpr double min_tolerance_share = 1e-5;
/// Directions may be off by so many times what is asked for in the mean over a cube: over all cubes
/// their median stays below that, and their 99th percentile below 3.75 times.
constexpr double leaf_direction = 1.8;
/// The smallest cubes of the octree, of the band's depth, and how often roots are halved to them:
/// so often that there are about this many along diagonal and margins.
constexpr double smallest_share = 0.25;
constexpr double roots_along = 32;
/// Where the tolerance is above this share of an edge, cubes of twice that edge may take fewer
/// bytes.
constexpr double coarse_share = 0.25;
/// Beyond this share of the finest of these, cubes are no smaller, whatever passes them.
constexpr double least_share = 0.1;

/// Coarser tolerances than this share of the band's depth leave polynomials as they are, or fit
/// larger ones in place of lists that take fewer bytes.
constexpr double max_tolerance_share = 0.4;

double depth_of(const Band& band) { return std::max(band.max_depth, band.margin); }

/// The tolerance with which the bake works: no finer than it can prove, and no coarser than saves
/// bytes, so that a coarser one never costs more of them.
double working_tolerance(const AssetMetadata& metadata, const Caster& caster) {
  const double coarsest = max_tolerance_share * depth_of(metadata.band);
  return std::max(std::min(*metadata.tolerance, coarsest), min_tolerance_share * caster.diagonal());
}

/// Finds which crossing along the rays of its plane each tile is, by the ray through its first
/// valid cell.
CastCounts count_layers(Asset& asset, const Caster& caster) {
  CastCounts counts;
  counts.rays = asset.tiles.size();
  for (TileData& data : asset.tiles) {
    const Tile tile = view_of(data, asset.metadata.tile_spacing, asset.metadata.height_unit);
    const auto cell = static_cast<std::uint32_t>(std::countr_zero(tile.valid));
    const auto spacing = static_cast<double>(tile.spacing);
    const std::uint32_t row = cell / tile_cells;
    const double x = cell % tile_cells + 0.5, y = row + 0.5;
    Column column;
    caster.cast(asset.planes[tile.plane], tile.eta0 + x * spacing, tile.omega0 + y * spacing,
                column);
    TileHeights heights;
    tile_heights(tile, static_cast<float>(asset.metadata.height_unit), heights);
    const double depth =
        tile.base + static_cast<double>(heights[row * tile_samples + cell % tile_cells]);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < column.crossings.size() && i < 256; ++i) {
      const double off = std::abs(column.crossings[i].depth - depth);
      if (!column.crossings[i].entry || off >= least) continue;
      least = off;
      data.first_layer = static_cast<std::uint32_t>(i);
    }
    counts.inconsistent += column.consistent ? 0 : 1;
    counts.layers_max =
        std::max(counts.layers_max, static_cast<std::uint32_t>(column.crossings.size()));
  }
  return counts;
}

/// Whether the middle of a valid cell of a tile has an answer.
bool shows_answers(const AssetView& view, const Tile& tile) {
  const SupportPlane& plane = view.planes[tile.plane];
  TileHeights heights;
  tile_heights(tile, view.height_unit, heights);
  const auto spacing = static_cast<double>(tile.spacing);
  for (std::uint32_t cell = 0; cell < tile_cell_count; ++cell) {
    if (((tile.valid >> cell) & 1U) == 0) continue;
    const std::uint32_t column = cell % tile_cells, row = cell / tile_cells;
    const double depth = tile.base + static_cast<double>(heights[row * tile_samples + column]);
    const Vector3 place = reconstructed_surface(plane, tile.eta0 + column * spacing,
                                                tile.omega0 + row * spacing, depth);
    if (leaf_at(view.octree, place).kind != OctreeKind::pruned) return true;
  }
  return false;
}

/// Leaves out tiles that show no place with an answer.
void drop_pruned_tiles(Asset& asset) {
  const AssetTables tables = tables_of(asset);
  const AssetView& view = tables.view();
  std::vector<TileData> kept;
  for (std::size_t i = 0; i < asset.tiles.size(); ++i) {
    if (shows_answers(view, view.tiles[i])) kept.push_back(asset.tiles[i]);
  }
  asset.tiles = std::move(kept);
}

AnswerShares answers_of(const OctreeCounts& counts) {
  return AnswerShares{counts.map_volume, counts.map_pair_volume, counts.polynomial_volume,
                      counts.list_volume}
      .of_all();
}

/// Bytes that rules saved: cubes that were left out would have taken as many as others on average.
std::vector<Pruned> pruned_by(const OctreeCounts& counts, const Reachability& reachability) {
  std::vector<Pruned> pruned;
  const double answered = counts.answered_volume();
  for (const PruneRule rule : {PruneRule::workspace, PruneRule::probe, PruneRule::unreachable}) {
    const double volume = counts.pruned_volume[static_cast<std::size_t>(rule)];
    if (!(volume > 0) && !reachability.checks(rule)) continue;
    const double share = answered > 0 ? volume / answered : 0;
    pruned.push_back({name_of(rule), static_cast<std::uint64_t>(
                                         std::llround(share * static_cast<double>(counts.bytes)))});
  }
  return pruned;
}

OctreeRules rules_for(const BakeOptions& options, const Asset& asset, const Caster& caster,
                      double tolerance, double smallest_edge) {
  const AssetMetadata& metadata = asset.metadata;
  OctreeRules rules;
  if (options.max_bytes) {
    rules.bytes =
        static_cast<double>(*options.max_bytes) - static_cast<double>(bytes_without_octree(asset));
  }
  rules.band = metadata.band;
  rules.tolerance = tolerance;
  rules.direction = leaf_direction * options.direction_tolerance;
  rules.smallest_edge = smallest_edge;
  rules.levels = 0;
  const double extent = caster.diagonal() + 2 * metadata.band.margin;
  while (rules.levels < max_octree_levels &&
         roots_along * std::ldexp(rules.smallest_edge, rules.levels) < extent) {
    ++rules.levels;
  }
  return rules;
}

/// The edges of the smallest cubes that are tried, m; the octree of the fewest bytes counts.
std::vector<double> smallest_edges(const BakeOptions& options, const Band& band,
                                   const Caster& caster, double tolerance) {
  const double fine = std::clamp(smallest_share * depth_of(band), tolerance,
                                 std::max(tolerance, caster.diagonal() / 16));
  if (tolerance <= coarse_share * fine) return {fine};
  if (options.max_bytes) return {2 * fine};
  return {fine, 2 * fine};
}

/// The share of the surface beside which trials tell the side, and no proof.
double tried_area(const LatticeSurface& lattice, const Caster& caster) {
  double tried = 0, all = 0;
  for (std::uint32_t t = 0; t < caster.triangle_count(); ++t) {
    const double area = caster.area(t);
    all += area;
    if (lattice.triangles[t].folded) tried += area;
  }
  return all > 0 ? tried / all : 0;
}

}  // namespace

void bake_sparse(BakeResult& result, const OuterSurface& surface, const Caster& caster,
                 const Hull& hull, const BakeOptions& options, const Progress& progress,
                 CastCounts& counts) {
  Asset& asset = result.asset;
  BakeReport& report = result.report;
  AssetMetadata& metadata = asset.metadata;
  const double tolerance = working_tolerance(metadata, caster);
  asset.planes = vertex_based_planes(hull, directions);
  metadata.kind = "vertex";
  // The file stores these planes with fewer digits. The rays must start from the planes that the
  // servo will read.
  round_to_stored(asset);

  const Clock::time_point started = Clock::now();
  SurfaceTiles known = show_surface(caster, asset, tolerance, options.seed, progress);
  asset.tiles = std::move(known.tiles);
  counts = count_layers(asset, caster);
  report.seconds_cast = seconds_since(started);
  report.stages.end("tiles");

  const Reachability reachability(caster, metadata.band, options.probe_radius, options.workspace,
                                  progress);
  report.stages.end("reachability");
  if (progress) progress("lattice", 0);
  const LatticeSurface lattice = round_to_lattice(surface, caster, known.bare, tolerance);
  const Caster& rounded = *lattice.caster;
  report.stages.end("lattice");
  std::vector<SupportPlane> map_planes = vertex_based_planes(hull, map_directions);
  round_planes(map_planes, metadata.diagonal);
  const auto map_spacing =
      static_cast<double>(static_cast<float>(map_spacing_share * caster.diagonal()));
  const PlaneCharts charts(lattice.surface, map_planes,
                           reach_depths * depth_of(metadata.band) + reach_spacings * map_spacing);
  const ChartHeights heights(lattice.surface, map_planes, charts, map_spacing, map_levels);
  report.stages.end("charts");
  std::optional<BuiltOctree> built;
  ProvenMaps proven;
  const auto build = [&](double edge, bool maps, ProvenMaps& cubes) {
    OctreeRules rules = rules_for(options, asset, caster, tolerance, edge);
    rules.maps = maps;
    return build_octree(lattice, rounded, asset.planes, heights,
                        reachability.cuts() ? &reachability : nullptr, rules, cubes, progress);
  };
  const auto try_edge = [&](double edge) {
    std::optional<BuiltOctree> next;
    try {
      next = build(edge, true, proven);
    } catch (const BakeError& error) {
      // Heights take bytes that few places share; polynomials alone may take fewer.
      if (!options.max_bytes || error.code() != ExitCode::tolerance_not_met) throw;
      ProvenMaps alone;
      next = build(edge, false, alone);
    }
    if (!built || std::pair(next->untold, next->counts.bytes) <
                      std::pair(built->untold, built->counts.bytes)) {
      built = std::move(next);
    }
  };
  const std::vector<double> edges = smallest_edges(options, metadata.band, caster, tolerance);
  for (const double edge : edges) try_edge(edge);
  // Where so many triangles pass a cube that no list can tell the side, smaller cubes can.
  for (double edge = edges.front() / 2; built->untold > 0 && edge > least_share * edges.front();
       edge /= 2) {
    try_edge(edge);
  }
  asset.octree = std::move(built->data);
  asset.atlas = std::move(built->atlas);
  asset.planes.insert(asset.planes.end(), built->planes.begin(), built->planes.end());
  report.stages.end("octree");
  if (reachability.cuts()) {
    drop_pruned_tiles(asset);
    report.pruned = pruned_by(built->counts, reachability);
  }
  asset.metadata.certified = tolerance;
  metadata.tried_area = tried_area(lattice, rounded);
  const AssetTables tables = tables_of(asset);
  result.served = try_served(tables.view(), caster, options.seed);
  report.stages.end("trials");
  report.seconds_fit += seconds_since(started) - report.seconds_cast;
  report.samples = asset.atlas.heights.size() + asset.tiles.size() * tile_sample_count;
  report.record_cells = built->counts.leaves();
  report.fallback_cells = built->counts.lists;
  report.answers = answers_of(built->counts);
  report.refused_tile_cells = known.refused_cells;
  report.fallback_area = known.bare_share;
}

}  // namespace spm::baker
