// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/pipeline/sparse.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "baker/base/bake_error.hpp"
#include "baker/base/stopwatch.hpp"
#include "baker/charts/chart_heights.hpp"
#include "baker/charts/plane_charts.hpp"
#include "baker/field/octree_build.hpp"
#include "baker/planes/planes.hpp"
#include "baker/reachability/reachability.hpp"
#include "common/surface/height_chart.hpp"
#include "formats/asset/asset_writer.hpp"

namespace spm::baker {

namespace {

/// Support planes of which charts choose.
constexpr std::size_t directions = 42;
/// The coarsest spacing of these maps, of the diagonal, which flat charts have; that of others is
/// halved down to a 64th, and twice more where it must be. Flat is what is so within a share of the
/// tolerance.
constexpr double map_spacing_share = 1.0 / 2;
constexpr std::uint32_t curved_level = 5, map_levels = 8;
constexpr double flat_share = 0.02;
/// Heights are HALF samples where the tolerance is this share of the diagonal or more, and so many
/// metres; below that, what they are rounded by would take too much of it.
constexpr double half_share = 4e-4, half_tolerance = 1e-6;
/// How far maps go on over what other planes see better, in depths of the band and spacings.
constexpr double reach_depths = 1, reach_spacings = 2;
/// Where the offset surface lies that maps of deep places are of, in depths of the band.
constexpr double offset_depth = 0.6;
/// Tolerances below this share of the diagonal are not proven, since the rounding of queries is no
/// longer small.
constexpr double min_tolerance_share = 1e-5;
/// Directions may be off by so many times what is asked for in the mean over a cube: over all cubes
/// their median stays below that, and their 99th percentile below 3.75 times.
/// Where little is asked for, what facets turn by counts in all cubes, and they are alike.
constexpr double leaf_direction = 2.1, fine_direction = 0.06, fine_leaf_direction = 1.5;
/// The smallest cubes of the octree, of the band's depth, but in a thin band no smaller than the
/// lesser of so many tolerances and that share of the diagonal: smaller ones take more bytes than
/// they save.
constexpr double smallest_share = 0.25, smallest_tolerances = 10, smallest_of_diagonal = 1.0 / 200;
/// Roots are no more than this along diagonal and margins, and take no more than that share of
/// bytes that are given.
constexpr double most_roots_along = 16, root_share = 0.1;
/// Where the tolerance is above this share of an edge, cubes of twice that edge take fewer bytes.
constexpr double coarse_share = 0.25;
/// Beyond this share of that, cubes are no smaller, whatever passes them.
constexpr double least_share = 0.1;

/// Coarser tolerances than this share of the band's depth leave maps as they are, or find larger
/// ones in place of lists that take fewer bytes.
constexpr double max_tolerance_share = 0.4;

double depth_of(const Band& band) { return std::max(band.max_depth, band.margin); }

/// The tolerance with which the bake works: no finer than it can prove, and no coarser than saves
/// bytes, so that a coarser one never costs more of them.
double working_tolerance(const AssetMetadata& metadata, const Caster& caster) {
  const double coarsest = max_tolerance_share * depth_of(metadata.band);
  return std::max(std::min(*metadata.tolerance, coarsest), min_tolerance_share * caster.diagonal());
}

/// Crossings along one ray of each distance map.
CastCounts count_layers(const AssetView& asset, const Caster& caster) {
  CastCounts counts;
  counts.rays = asset.charts.size();
  for (const HeightChart& chart : asset.charts) {
    const SupportPlane& plane = asset.planes[chart.plane];
    const Vector3 place = chart_point(chart, plane, chart.columns / 2.0, chart.rows / 2.0);
    Column column;
    caster.cast(plane, plane.u.dot(place - plane.x0), plane.v.dot(place - plane.x0), column);
    counts.inconsistent += column.consistent ? 0 : 1;
    counts.layers_max =
        std::max(counts.layers_max, static_cast<std::uint32_t>(column.crossings.size()));
  }
  return counts;
}

/// Bytes that rules saved: cubes that were left out would have taken as many as others on average.
std::vector<Pruned> pruned_by(const OctreeCounts& counts, const Reachability& reachability) {
  std::vector<Pruned> pruned;
  const double answered = counts.answered_volume;
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
  rules.direction =
      (options.direction_tolerance < fine_direction ? fine_leaf_direction : leaf_direction) *
      options.direction_tolerance;
  rules.smallest_edge = smallest_edge;
  rules.levels = 0;
  const double extent = caster.diagonal() + 2 * metadata.band.margin;
  const auto too_many_roots = [&] {
    const double along = extent / std::ldexp(rules.smallest_edge, rules.levels);
    return along > most_roots_along ||
           (rules.bytes &&
            sizeof(std::uint32_t) * along * along * along > root_share * *rules.bytes);
  };
  while (rules.levels < max_octree_levels && too_many_roots()) ++rules.levels;
  return rules;
}

/// m, of the smallest cubes.
double smallest_edge(const Band& band, const Caster& caster, double tolerance) {
  const double thin =
      std::min(smallest_tolerances * tolerance, smallest_of_diagonal * caster.diagonal());
  const double fine = std::clamp(std::max(smallest_share * depth_of(band), thin), tolerance,
                                 std::max(tolerance, caster.diagonal() / 16));
  return tolerance <= coarse_share * fine ? fine : 2 * fine;
}

/// The share of the surface beside which sides are only tried.
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
  metadata.kind = "vertex";
  const Clock::time_point started = Clock::now();
  const Reachability reachability(caster, metadata.band, options.probe_radius, options.workspace,
                                  progress);
  report.stages.end("reachability");
  if (progress) progress("lattice", 0);
  const LatticeSurface lattice = round_to_lattice(surface, caster, tolerance);
  const Caster& rounded = *lattice.caster;
  report.stages.end("lattice");
  std::vector<SupportPlane> planes = vertex_based_planes(hull, directions);
  // The file stores these planes with fewer digits.
  round_planes(planes, metadata.diagonal);
  const auto map_spacing =
      static_cast<double>(static_cast<float>(map_spacing_share * caster.diagonal()));
  const PlaneCharts charts(lattice.surface, planes,
                           reach_depths * depth_of(metadata.band) +
                               std::ldexp(reach_spacings * map_spacing, -int{curved_level}));
  const Clock::time_point casting = Clock::now();
  const ChartHeights heights(
      rounded, lattice.surface, planes, charts,
      {.coarsest = map_spacing,
       .curved = curved_level,
       .levels = map_levels,
       .flat_within = flat_share * tolerance,
       .halves = tolerance >= std::max(half_share * caster.diagonal(), half_tolerance),
       .offset = static_cast<double>(static_cast<float>(-offset_depth * metadata.band.max_depth)),
       .offset_levels = map_levels - 1});
  report.seconds_cast = seconds_since(casting);
  report.stages.end("charts");
  const auto build = [&](double edge) {
    OctreeRules rules = rules_for(options, asset, caster, tolerance, edge);
    const auto built = [&] {
      return build_octree(lattice, rounded, heights, reachability.cuts() ? &reachability : nullptr,
                          rules, progress);
    };
    BuiltOctree octree = built();
    if (octree.atlas.charts.size() <= max_named_maps) return octree;
    rules.maps = false;  // words cannot name so many
    return built();
  };
  const double smallest = smallest_edge(metadata.band, caster, tolerance);
  BuiltOctree built = build(smallest);
  // Where so many triangles pass a cube that no list can tell the side, smaller cubes can.
  for (double edge = smallest / 2; built.untold > 0 && edge > least_share * smallest; edge /= 2) {
    BuiltOctree next = build(edge);
    if (next.untold < built.untold) built = std::move(next);
  }
  asset.octree = std::move(built.data);
  asset.atlas = std::move(built.atlas);
  asset.planes = std::move(built.planes);
  report.stages.end("octree");
  if (reachability.cuts()) report.pruned = pruned_by(built.counts, reachability);
  asset.metadata.certified = tolerance;
  metadata.tried_area = tried_area(lattice, rounded);
  const AssetTables tables = tables_of(asset);
  counts = count_layers(tables.view(), caster);
  report.seconds_fit += seconds_since(started) - report.seconds_cast;
  report.samples = asset.atlas.heights.size();
  report.record_cells = built.counts.leaves();
  report.fallback_cells = built.counts.lists;
}

}  // namespace spm::baker
