// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/pipeline/sparse.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "baker/base/stopwatch.hpp"
#include "baker/pipeline/sparse_model.hpp"
#include "baker/reachability/reachability.hpp"
#include "baker/tiles/tile_fit.hpp"
#include "baker/trees/sign_octree_build.hpp"
#include "baker/trials/side_trials.hpp"

namespace spm::baker {

namespace {

constexpr std::size_t directions = 8;
constexpr double coarsest_spacing_share = 1.0 / 64;  ///< of the diagonal
constexpr double surfel_spacing_share = 1.0 / 350;   ///< of the diagonal
/// Share of the tolerance by which a tile's cells may be off the surface. The rest is for the gaps
/// between them.
constexpr double residual_share = 0.5;
/// Tolerances below this share of the diagonal are not proven, since the rounding of queries, in
/// floats, is no longer small.
constexpr double min_tolerance_share = 1e-5;

/// The tolerance with which the bake works: no finer than it can prove.
double provable(const AssetMetadata& metadata, const Caster& caster) {
  return std::max(*metadata.tolerance, min_tolerance_share * caster.diagonal());
}

TileSettings settings_for(const Caster& caster, double tolerance) {
  TileSettings settings;
  settings.tile_spacing =
      static_cast<double>(static_cast<float>(coarsest_spacing_share * caster.diagonal()));
  settings.height_unit = std::exp2(std::floor(std::log2(caster.diagonal() / 100)));
  settings.residual = residual_share * tolerance;
  settings.surfel_spacing = surfel_spacing_share * caster.diagonal();
  return settings;
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
    const double x = cell % tile_cells + 0.5, y = cell / tile_cells + 0.5;
    Column column;
    caster.cast(asset.planes[tile.plane], tile.eta0 + x * spacing, tile.omega0 + y * spacing,
                column);
    TileHeights heights;
    tile_heights(tile, static_cast<float>(asset.metadata.height_unit), heights);
    const double depth =
        tile.base +
        static_cast<double>(heights[cell / tile_cells * tile_samples + cell % tile_cells]);
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

/// Drops the planes on which no tile lies: the plane table is most of the overhead of a small file.
void drop_unused_planes(Asset& asset) {
  constexpr std::uint32_t unused = 0xFFFFFFFF;
  std::vector<std::uint32_t> row(asset.planes.size(), unused);
  std::vector<SupportPlane> kept;
  for (TileData& tile : asset.tiles) {
    std::uint32_t& place = row[tile.plane];
    if (place == unused) {
      place = static_cast<std::uint32_t>(kept.size());
      kept.push_back(asset.planes[tile.plane]);
    }
    tile.plane = place;
  }
  asset.planes = std::move(kept);
}

}  // namespace

void bake_sparse(BakeResult& result, const Caster& caster, const Hull& hull,
                 const BakeOptions& options, const Progress& progress, CastCounts& counts) {
  Asset& asset = result.asset;
  BakeReport& report = result.report;
  AssetMetadata& metadata = asset.metadata;
  const double tolerance = provable(metadata, caster);
  asset.planes = vertex_based_planes(hull, directions);
  metadata.kind = "vertex";
  // The file stores these planes with fewer digits. The rays must start from the planes that the
  // servo will read.
  round_to_stored(asset);
  const TileSettings settings = settings_for(caster, tolerance);
  metadata.tile_spacing = settings.tile_spacing;
  metadata.height_unit = settings.height_unit;

  const Clock::time_point started = Clock::now();
  const Reachability reachability(caster, metadata.band, options.probe_radius, options.workspace,
                                  progress);
  SignOctreeBuilder sign_octree(caster, metadata.band, tolerance,
                                reachability.cuts() ? &reachability : nullptr, progress);
  SparseModel model = model_surface(
      asset, settings, {caster, sign_octree, reachability, tolerance, options.seed, progress});
  asset = std::move(model.asset);
  report.pruned = std::move(model.pruned);
  counts = count_layers(asset, caster);
  drop_unused_planes(asset);
  round_to_stored(asset);
  const SideTrials sides = try_sides(asset, caster, sign_octree, progress);
  asset.metadata.certified = tolerance;
  report.seconds_cast = model.seconds_cast;
  report.seconds_fit += seconds_since(started) - model.seconds_cast;
  report.samples = asset.tiles.size() * tile_sample_count;
  report.record_cells = sides.cells;
  report.fallback_cells = sides.fallback_cells;
  report.resolved_places = sides.resolved;
  report.wrong_trials = sides.wrong;
  report.refused_tile_cells = model.refused_cells;
  report.fallback_area = model.triangle_area_share;
  report.direction = model.direction;
  if (model.direction > 1.1 * max_direction) {
    report.notes.push_back(
        fmt::format("directions are off by {:.1f} degrees in the median, for the surface has "
                    "facets smaller than what a file of {:.2g} MB can follow",
                    model.direction * 180 / std::numbers::pi, direction_bytes / 1e6));
  }
}

}  // namespace spm::baker
