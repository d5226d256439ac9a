// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/sparse.hpp"

#include <bit>
#include <cmath>
#include <iterator>
#include <limits>

#include "baker/bake_error.hpp"
#include "baker/element_choice.hpp"
#include "baker/fallback_triangles.hpp"
#include "baker/reach.hpp"
#include "baker/side_trials.hpp"
#include "baker/space_build.hpp"
#include "baker/stopwatch.hpp"
#include "baker/surface_proof.hpp"
#include "baker/tile_fit.hpp"
#include "baker/tiles.hpp"
#include "baker/tree_elements.hpp"

namespace spm::baker {

namespace {

constexpr std::size_t directions = 20;
constexpr double coarsest_spacing_share = 1.0 / 64;  ///< of the diagonal
constexpr double surfel_spacing_share = 1.0 / 350;   ///< of the diagonal
/// Share of the tolerance that a tile's cells may leave the surface by; the rest is for the gaps
/// between them.
constexpr double residual_share = 0.5;
/// Rounds in which gaps between tiles get tiles of their own, where one closes so many pieces.
constexpr int gap_rounds = 1;
constexpr double gap_pieces = 4;
/// Share of the tolerance that is proven, rounding included; the rest is for places where the side
/// is in doubt, whose distances the query takes as less.
constexpr double proven_share = 0.95;
/// Below this share of the diagonal the rounding of queries, in floats, is no longer small.
constexpr double least_tolerance_share = 1e-5;

/// The tolerance that the bake works to: no finer than it can prove.
double provable(const AssetMetadata& metadata, const Caster& caster) {
  return std::max(*metadata.tolerance, least_tolerance_share * caster.diagonal());
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

/// Tiles all over the surface, proven, and what of it they stand for.
SurfaceCover cover_surface(const Caster& caster, Asset& asset, TileSettings settings,
                           std::uint64_t seed, const Progress& progress, ProofCounts& counts) {
  const double tolerance = provable(asset.metadata, caster);
  const double bound = proven_share * tolerance - FallbackTriangles::rounding(tolerance);
  const Band& band = asset.metadata.band;
  const double farthest = std::max(band.max_depth, band.margin) + tolerance;
  std::vector<SurfacePoint> points = surface_points(caster, settings.surfel_spacing, 0, seed);
  SurfaceCover cover;
  for (int round = 0; round <= gap_rounds && !points.empty(); ++round) {
    std::vector<TileData> more = cast_tiles(caster, asset.planes, settings, points, progress);
    prove_tiles(caster, asset.planes, more, settings.tile_spacing, settings.height_unit, bound,
                progress, counts);
    std::move(more.begin(), more.end(), std::back_inserter(asset.tiles));
    std::vector<Tile> views;
    for (const TileData& tile : asset.tiles) {
      views.push_back(view_of(tile, settings.tile_spacing, settings.height_unit));
    }
    cover =
        prove_surface(caster, asset.planes, views, settings.height_unit, bound, farthest, progress);
    points.clear();
    for (const auto& open : cover.open) {
      for (const SurfacePiece& piece : open) {
        points.push_back(
            {(piece.corners[0] + piece.corners[1] + piece.corners[2]) / 3, piece.triangle});
      }
    }
    settings.least_surfels = gap_pieces;
  }
  return cover;
}

/// Finds which crossing of its plane's rays each tile is, by the ray through its first valid cell.
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

/// Leaves out the planes that no tile lies on: the plane table is most of a small file's overhead.
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
  // The file keeps these planes in fewer digits: the rays must start from what the servo will read.
  round_to_stored(asset);
  const TileSettings settings = settings_for(caster, tolerance);
  metadata.tile_spacing = settings.tile_spacing;
  metadata.height_unit = settings.height_unit;

  const Clock::time_point casting = Clock::now();
  ProofCounts proof;
  const SurfaceCover cover = cover_surface(caster, asset, settings, options.seed, progress, proof);
  report.seconds_cast = seconds_since(casting);

  const Clock::time_point fitting = Clock::now();
  ElementChoice choice = choose_elements(caster, std::move(asset.tiles), cover);
  asset.tiles = std::move(choice.tiles);
  const Reach reach(caster, metadata.band, options.probe_radius, options.workspace, progress);
  SpaceBuilder space(caster, metadata.band, tolerance, reach.cuts() ? &reach : nullptr, progress);
  const TreeElements elements(caster, choice.triangles, tolerance);
  report.pruned = elements.build(asset, space, reach.cuts() ? &reach : nullptr);
  if (asset.tree.words.empty()) {
    throw BakeError(ExitCode::invalid_input,
                    "nothing of the object is left to model: the probe's centre comes to no place "
                    "of its band; move the object into the workspace, or take a smaller probe");
  }
  counts = count_layers(asset, caster);
  drop_unused_planes(asset);
  round_to_stored(asset);
  const SideTrials sides = try_sides(asset, caster, space, progress);
  metadata.certified = tolerance;
  report.seconds_fit += seconds_since(fitting);
  report.samples = asset.tiles.size() * tile_sample_count;
  report.record_cells = sides.cells;
  report.fallback_cells = sides.fallback_cells;
  report.mended_places = sides.mended;
  report.wrong_trials = sides.wrong;
  report.refused_tile_cells = proof.refused_cells;
  report.fallback_area = choice.triangle_area_share;
}

}  // namespace spm::baker
