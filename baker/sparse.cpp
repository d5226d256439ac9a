// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/sparse.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include "baker/bake_error.hpp"
#include "baker/direction_error.hpp"
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

constexpr std::size_t directions = 8;
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
constexpr double proven_share = 0.85;
/// Share of the surface that triangles may stand for without asking; and where facets ask for it.
constexpr double free_share = 0.18;
constexpr double facet_share = 0.23;
/// Directions that are off by more in the median, rad, ask for finer tiles, which aim at less, as
/// long as all takes no more bytes than so many.
constexpr double most_direction = 0.95 * std::numbers::pi / 180;
constexpr double aimed_direction = 0.9 * std::numbers::pi / 180;
constexpr double direction_bytes = 0.98e6;
constexpr int direction_rounds = 2;
/// What fitting facets and more triangles are known to make of the error of directions.
constexpr double facet_gain = 0.85;
/// How the error of directions, and bytes, go with the angle that tiles are allowed: as its powers.
constexpr double direction_power = 0.67;
constexpr double bytes_power = -0.6;
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

/// What a `sparse` asset is made of, by some settings.
struct Model {
  Asset asset;
  ProofCounts proof;
  std::vector<Pruned> pruned;
  double triangle_area_share = 0;
  double direction = 0;  ///< median error, rad
  double bytes = 0;      ///< about
  double seconds_cast = 0;
};

/// Makes models of a surface, and judges their directions.
class Modeller {
 public:
  /// Keeps references.
  Modeller(const Caster& caster, const SpaceBuilder& space, const Reach& reach,
           const BakeOptions& options, const Progress& progress)
      : caster_(caster), space_(space), reach_(reach), options_(options), progress_(progress) {}

  /// The model of `start`, which has metadata and planes only.
  [[nodiscard]] Model model(const Asset& start, const TileSettings& settings, double share) const {
    Model result;
    result.asset = start;
    Asset& asset = result.asset;
    const Clock::time_point casting = Clock::now();
    const SurfaceCover cover =
        cover_surface(caster_, asset, settings, options_.seed, progress_, result.proof);
    result.seconds_cast = seconds_since(casting);
    ElementChoice choice = choose_elements(caster_, std::move(asset.tiles), cover, share);
    asset.tiles = std::move(choice.tiles);
    result.triangle_area_share = choice.triangle_area_share;
    const TreeElements elements(caster_, choice.triangles, provable(asset.metadata, caster_));
    result.pruned = elements.build(asset, space_, reach_.cuts() ? &reach_ : nullptr);
    if (asset.tree.words.empty()) {
      throw BakeError(
          ExitCode::invalid_input,
          "nothing of the object is left to model: the probe's centre comes to no place "
          "of its band; move the object into the workspace, or take a smaller probe");
    }
    asset.space = space_.data();
    result.direction = median_direction_error(asset, caster_, options_.seed);
    result.bytes = bytes_of(asset);
    return result;
  }

  /// With finer tiles, where directions ask for them and a file of a sensible size gives them.
  [[nodiscard]] Model finer(const Asset& start, TileSettings settings, Model known) const {
    settings.faceted = true;
    double seconds = known.seconds_cast;
    Model last = known;
    for (int round = 0; round < direction_rounds && known.direction > most_direction; ++round) {
      const double known_gain = round == 0 ? facet_gain : 1;
      const double wanted = std::min(
          1.0, std::pow(aimed_direction / (known_gain * last.direction), 1 / direction_power));
      const double allowed = std::pow(direction_bytes / last.bytes, 1 / bytes_power);
      const double share = std::max(wanted, allowed);
      // Not worth it where the file would be too large for what is wanted.
      const double expected = last.direction * std::pow(share, direction_power);
      if (expected > 1.2 * most_direction || share > 1) break;
      settings.angle *= share;
      last = model(start, settings, facet_share);
      seconds += last.seconds_cast;
      if (last.direction < known.direction && last.bytes <= direction_bytes) known = last;
    }
    known.seconds_cast = seconds;
    return known;
  }

 private:
  const Caster& caster_;
  const SpaceBuilder& space_;
  const Reach& reach_;
  const BakeOptions& options_;
  const Progress& progress_;

  /// About what an asset's parts take in a file.
  [[nodiscard]] static double bytes_of(const Asset& asset) {
    std::uint64_t bytes = 4 * (asset.tree.words.size() + asset.space.words.size()) +
                          2 * asset.small_triangles.size() + 4 * asset.triangles.size();
    for (const TileData& tile : asset.tiles) bytes += tile_bytes(tile) - tree_bytes;
    return static_cast<double>(bytes);
  }
};

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

  const Clock::time_point started = Clock::now();
  const Reach reach(caster, metadata.band, options.probe_radius, options.workspace, progress);
  SpaceBuilder space(caster, metadata.band, tolerance, reach.cuts() ? &reach : nullptr, progress);
  const Modeller modeller(caster, space, reach, options, progress);
  Model model = modeller.model(asset, settings, free_share);
  model = modeller.finer(asset, settings, std::move(model));
  asset = std::move(model.asset);
  report.pruned = std::move(model.pruned);
  counts = count_layers(asset, caster);
  drop_unused_planes(asset);
  round_to_stored(asset);
  const SideTrials sides = try_sides(asset, caster, space, progress);
  asset.metadata.certified = tolerance;
  report.seconds_cast = model.seconds_cast;
  report.seconds_fit += seconds_since(started) - model.seconds_cast;
  report.samples = asset.tiles.size() * tile_sample_count;
  report.record_cells = sides.cells;
  report.fallback_cells = sides.fallback_cells;
  report.mended_places = sides.mended;
  report.wrong_trials = sides.wrong;
  report.refused_tile_cells = model.proof.refused_cells;
  report.fallback_area = model.triangle_area_share;
  report.direction = model.direction;
  if (model.direction > 1.1 * most_direction) {
    report.notes.push_back(fmt::format(
        "directions are off by {:.1f} degrees in the median: the surface has facets so small that "
        "following them would take more than {:.2g} MB",
        model.direction * 180 / std::numbers::pi, direction_bytes / 1e6));
  }
}

}  // namespace spm::baker
