// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/pipeline/surface_tiles.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "baker/field/octree_triangles.hpp"
#include "baker/proof/surface_proof.hpp"
#include "baker/proof/tile_proof.hpp"
#include "baker/tiles/tile_fit.hpp"
#include "baker/tiles/tiles.hpp"
#include "formats/asset/tile_words.hpp"

namespace spm::baker {

namespace {

constexpr double coarsest_spacing_share = 1.0 / 64;  ///< of the diagonal
constexpr double surfel_spacing_share = 1.0 / 350;   ///< of the diagonal
/// Share of the tolerance by which a tile's cells may be off the surface. The rest is for the gaps
/// between them.
constexpr double residual_share = 0.5;
/// Bytes of a tile without masks and clips.
constexpr std::uint64_t whole_tile_bytes = 2 * tile_sample_count + 4 * tile_words;

TileSettings settings_for(const Caster& caster, double tolerance) {
  TileSettings settings;
  settings.tile_spacing =
      static_cast<double>(static_cast<float>(coarsest_spacing_share * caster.diagonal()));
  settings.height_unit = std::exp2(std::floor(std::log2(caster.diagonal() / 100)));
  settings.residual = residual_share * tolerance;
  settings.surfel_spacing = surfel_spacing_share * caster.diagonal();
  settings.least_triangles = static_cast<double>(whole_tile_bytes) / stored_triangle_bytes;
  return settings;
}

std::uint64_t tile_bytes(const TileData& tile) {
  return whole_tile_bytes + (~tile.valid != 0 ? 8 : 0) +
         (tile.clipped != 0 ? 8 + 4 * tile.clips.size() : 0);
}

}  // namespace

SurfaceTiles show_surface(const Caster& caster, Asset& asset, double tolerance, std::uint64_t seed,
                          const Progress& progress) {
  SurfaceTiles known;
  const TileSettings settings = settings_for(caster, tolerance);
  asset.metadata.tile_spacing = settings.tile_spacing;
  asset.metadata.height_unit = settings.height_unit;
  if (caster.solid_count() == 0) {
    known.bare_share = 1;
    return known;
  }
  std::vector<TileData> tiles =
      cast_tiles(caster, asset.planes, settings,
                 surface_points(caster, settings.surfel_spacing, 0, seed), progress);
  ProofCounts counts;
  prove_tiles(caster, asset.planes, tiles, settings.tile_spacing, settings.height_unit, tolerance,
              progress, counts);
  known.refused_cells = counts.refused_cells;
  std::vector<Tile> views;
  views.reserve(tiles.size());
  for (const TileData& tile : tiles) {
    views.push_back(view_of(tile, settings.tile_spacing, settings.height_unit));
  }
  const SurfaceCover cover =
      prove_surface(caster, asset.planes, views, settings.height_unit, tolerance, progress);
  const std::size_t triangles = cover.uses.size();
  known.bare.assign(triangles, false);
  std::vector<std::uint64_t> shown(tiles.size(), 0);
  for (std::uint32_t t = 0; t < triangles; ++t) {
    known.bare[t] = cover.open[t].has_value();
    if (known.bare[t]) continue;
    for (const TileUse& use : cover.uses[t]) ++shown[use.tile];
  }
  // A tile that shows few triangles takes more bytes than they do, beside corners that their
  // neighbours have too.
  for (std::uint32_t t = 0; t < triangles; ++t) {
    known.bare[t] =
        known.bare[t] ||
        std::any_of(cover.uses[t].begin(), cover.uses[t].end(), [&](const TileUse& use) {
          return shown[use.tile] * stored_triangle_bytes < tile_bytes(tiles[use.tile]);
        });
  }
  std::vector<std::uint64_t> used(tiles.size(), 0);
  double bare = 0, all = 0;
  for (std::uint32_t t = 0; t < caster.triangle_count(); ++t) {
    const double area = caster.area(t);
    all += area;
    const bool shown_by_tiles = t < triangles && !known.bare[t];
    bare += shown_by_tiles ? 0 : area;
    if (!shown_by_tiles) continue;
    for (const TileUse& use : cover.uses[t]) used[use.tile] |= use.cells;
  }
  trim_tiles(tiles, used);
  known.tiles = std::move(tiles);
  known.bare_share = all > 0 ? bare / all : 0;
  return known;
}

}  // namespace spm::baker
