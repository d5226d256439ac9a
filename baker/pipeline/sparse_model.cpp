// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/pipeline/sparse_model.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "baker/base/bake_error.hpp"
#include "baker/base/stopwatch.hpp"
#include "baker/proof/surface_proof.hpp"
#include "baker/proof/tile_proof.hpp"
#include "baker/tiles/tile_fit.hpp"
#include "baker/trees/bvh_elements.hpp"
#include "baker/trees/element_choice.hpp"
#include "baker/trees/fallback_triangles.hpp"
#include "baker/trials/direction_error.hpp"

namespace spm::baker {

namespace {

/// Rounds in which the gaps between tiles get tiles of their own, where one tile closes this many
/// pieces.
constexpr int gap_rounds = 1;
constexpr double gap_pieces = 4;
/// Share of the tolerance that is proven, rounding included. The rest is for places where the side
/// is in doubt: the query takes their distances as less.
constexpr double proven_share = 0.85;
/// Share of the surface that triangles may represent: usually, and where small facets make it
/// necessary.
constexpr double free_share = 0.18;
constexpr double facet_share = 0.23;
/// The median error of directions that finer tiles aim at, rad, and how often they are tried.
constexpr double aimed_direction = 0.9 * std::numbers::pi / 180;
constexpr int direction_rounds = 2;
/// The factor on the error of directions from fitting facets and from more triangles, as measured
/// before.
constexpr double facet_gain = 0.85;
/// The error of directions and the bytes are about these powers of the angle that tiles are
/// allowed.
constexpr double direction_power = 0.67;
constexpr double bytes_power = -0.6;

/// Casts tiles all over the surface, proves them, and finds what of the surface they cover.
SurfaceCover cover_surface(const ModelSource& source, Asset& asset, TileSettings settings,
                           ProofCounts& counts) {
  const Caster& caster = source.caster;
  const double tolerance = source.tolerance;
  const double bound = proven_share * tolerance - FallbackTriangles::rounding(tolerance);
  const Band& band = asset.metadata.band;
  const double farthest = std::max(band.max_depth, band.margin) + tolerance;
  std::vector<SurfacePoint> points =
      surface_points(caster, settings.surfel_spacing, 0, source.seed);
  SurfaceCover cover;
  for (int round = 0; round <= gap_rounds && !points.empty(); ++round) {
    std::vector<TileData> more =
        cast_tiles(caster, asset.planes, settings, points, source.progress);
    prove_tiles(caster, asset.planes, more, settings.tile_spacing, settings.height_unit, bound,
                source.progress, counts);
    std::move(more.begin(), more.end(), std::back_inserter(asset.tiles));
    std::vector<Tile> views;
    for (const TileData& tile : asset.tiles) {
      views.push_back(view_of(tile, settings.tile_spacing, settings.height_unit));
    }
    cover = prove_surface(caster, asset.planes, views, settings.height_unit, bound, farthest,
                          source.progress);
    points.clear();
    for (const auto& open : cover.open) {
      for (const SurfacePiece& piece : open) {
        points.push_back(
            {(piece.corners[0] + piece.corners[1] + piece.corners[2]) / 3, piece.triangle});
      }
    }
    settings.min_surfels = gap_pieces;
  }
  return cover;
}

/// Makes models of a surface, and judges their directions.
class Modeller {
 public:
  explicit Modeller(const ModelSource& source) : source_(source) {}

  /// The model of `start`, which has metadata and planes only.
  [[nodiscard]] SparseModel model(const Asset& start, const TileSettings& settings,
                                  double share) const {
    SparseModel result;
    ProofCounts proof;
    result.asset = start;
    Asset& asset = result.asset;
    const Clock::time_point casting = Clock::now();
    const SurfaceCover cover = cover_surface(source_, asset, settings, proof);
    result.seconds_cast = seconds_since(casting);
    result.refused_cells = proof.refused_cells;
    ElementChoice choice = choose_elements(source_.caster, std::move(asset.tiles), cover, share);
    asset.tiles = std::move(choice.tiles);
    result.triangle_area_share = choice.triangle_area_share;
    const BvhElements elements(source_.caster, choice.triangles, source_.tolerance);
    result.pruned = elements.build(asset, source_.sign_octree,
                                   source_.reachability.cuts() ? &source_.reachability : nullptr);
    if (asset.bvh.words.empty()) {
      throw BakeError(
          ExitCode::invalid_input,
          "nothing of the object is left to model: the probe's centre comes to no place "
          "of its band; move the object into the workspace, or take a smaller probe");
    }
    asset.sign_octree = source_.sign_octree.data();
    result.direction = median_direction_error(asset, source_.caster, source_.seed);
    result.bytes = bytes_of(asset);
    return result;
  }

  /// The model with finer tiles, where directions ask for them and a file of a sensible size allows
  /// them.
  [[nodiscard]] SparseModel finer(const Asset& start, TileSettings settings,
                                  SparseModel known) const {
    settings.faceted = true;
    double seconds = known.seconds_cast;
    double direction = known.direction, bytes = known.bytes;
    for (int round = 0; round < direction_rounds && known.direction > max_direction; ++round) {
      const double known_gain = round == 0 ? facet_gain : 1;
      const double wanted =
          std::min(1.0, std::pow(aimed_direction / (known_gain * direction), 1 / direction_power));
      const double allowed = std::pow(direction_bytes / bytes, 1 / bytes_power);
      const double share = std::max(wanted, allowed);
      // Not worth it where the file would be too large for the wanted error.
      const double expected = direction * std::pow(share, direction_power);
      if (expected > 1.2 * max_direction || share > 1) break;
      settings.angle *= share;
      SparseModel made = model(start, settings, facet_share);
      direction = made.direction;
      bytes = made.bytes;
      seconds += made.seconds_cast;
      if (direction < known.direction && bytes <= direction_bytes) known = std::move(made);
    }
    known.seconds_cast = seconds;
    return known;
  }

 private:
  const ModelSource& source_;

  /// An estimate of the bytes of an asset's parts in a file.
  [[nodiscard]] static double bytes_of(const Asset& asset) {
    std::uint64_t bytes = 4 * (asset.bvh.words.size() + asset.sign_octree.words.size()) +
                          2 * asset.small_triangles.size() + 4 * asset.triangles.size();
    for (const TileData& tile : asset.tiles) bytes += tile_bytes(tile) - bvh_bytes;
    return static_cast<double>(bytes);
  }
};

}  // namespace

SparseModel model_surface(const Asset& start, const TileSettings& settings,
                          const ModelSource& source) {
  const Modeller modeller(source);
  return modeller.finer(start, settings, modeller.model(start, settings, free_share));
}

}  // namespace spm::baker
