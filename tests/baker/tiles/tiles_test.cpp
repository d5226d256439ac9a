// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/tiles/tiles.hpp"

#include <bit>
#include <catch2/catch.hpp>
#include <cmath>

#include "baker/proof/surface_proof.hpp"
#include "baker/proof/tile_bins.hpp"
#include "baker/proof/tile_proof.hpp"
#include "baker/tiles/clip_fit.hpp"
#include "baker/tiles/closest_on_tile.hpp"
#include "baker/tiles/tile_fit.hpp"
#include "common/base/random.hpp"
#include "common/query/query.hpp"
#include "common/surface/closest_on_triangle.hpp"
#include "common/surface/support_plane_mapping.hpp"
#include "tests/baker/pipeline/bake_support.hpp"

namespace spm::baker::tiles_test {
namespace {

constexpr double unit = 0x1p-10;
constexpr double spacing = 0x1p-10;  // near a millimetre, and exact in single precision

/// Six planes around the object, along the axes.
std::vector<SupportPlane> axis_planes(double distance) {
  std::vector<SupportPlane> planes;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {1.0, -1.0}) {
      const Vector3 normal = side * Vector3::Unit(axis);
      planes.push_back(plane_with_normal(distance * normal, normal));
    }
  }
  return planes;
}

TileSettings settings_for(double tolerance) {
  TileSettings settings;
  settings.tile_spacing = spacing;
  settings.height_unit = unit;
  settings.residual = tolerance / 2;
  settings.surfel_spacing = 3e-4;
  return settings;
}

std::vector<Tile> views_of(const std::vector<TileData>& tiles) {
  std::vector<Tile> views;
  for (const TileData& tile : tiles) views.push_back(view_of(tile, spacing, unit));
  return views;
}

std::size_t open_triangles(const SurfaceCover& cover) {
  return static_cast<std::size_t>(std::count_if(cover.open.begin(), cover.open.end(),
                                                [](const auto& open) { return open.has_value(); }));
}

/// Proven tiles over a shape, and what of it they cover.
struct Covered {
  Caster caster;
  std::vector<SupportPlane> planes;
  std::vector<TileData> tiles;
  SurfaceCover cover;
  ProofCounts counts;

  Covered(const test::Shape& shape, double tolerance)
      : caster(test::surface_of(shape)), planes(axis_planes(0.05)) {
    const TileSettings settings = settings_for(tolerance);
    tiles = cast_tiles(caster, planes, settings,
                       surface_points(caster, settings.surfel_spacing, 0, 1), {});
    prove_tiles(caster, planes, tiles, spacing, unit, tolerance, {}, counts);
    cover = prove_surface(caster, planes, views_of(tiles), unit, tolerance, {});
  }
};

TEST_CASE("A clip line is found along a straight crease, whichever way it runs") {
  for (int k = 0; k < 24; ++k) {
    const double angle = 0.27 * k, a = std::cos(angle), b = std::sin(angle);
    const double offset = 0.25 * (random_unit(3, static_cast<std::uint64_t>(k)) - 0.5);
    const auto on_layer = [&](double x, double y) {
      return a * (x - 3.5) + b * (y - 2.5) <= offset;
    };
    const std::optional<Clip> clip = fit_clip(3.5, 2.5, on_layer);
    REQUIRE(clip);
    const auto length = static_cast<double>(std::hypot(clip->a, clip->b));
    CHECK(static_cast<double>(clip->a) / length == Approx(a).margin(0.03));
    CHECK(static_cast<double>(clip->b) / length == Approx(b).margin(0.03));
    CHECK(static_cast<double>(clip->c) / length == Approx(offset).margin(0.02));
  }
}

TEST_CASE("A cell that the sheet hardly reaches into gets no clip line") {
  CHECK_FALSE(fit_clip(0.5, 0.5, [](double, double) { return false; }));
  CHECK_FALSE(fit_clip(0.5, 0.5, [](double x, double y) { return x < 0.05 && y < 0.05; }));
}

TEST_CASE("A tile on a box's face stands for the face up to its edges and not beyond") {
  const test::Shape box = test::box({0.03, 0.03, 0.03});
  const Caster caster(test::surface_of(box));
  const std::vector<SupportPlane> planes = axis_planes(0.015);
  const TileSite site{planes[0], 0, 0, 2, 2, spacing, unit, 5e-5, 0.1, 0.3};
  // The tile over [8, 16] spacings along both ways, of which the face takes 15 mm.
  const std::optional<TileFit> fit = fit_tile(caster, site, {0.01, 0.01, 0});
  REQUIRE(fit);
  REQUIRE(fit->good);
  CHECK(fit->data.valid != 0);
  // The last column and the last row; the corner, with two creases, has one line as well.
  CHECK(std::popcount(fit->data.clipped) == 15);
  const Tile tile = view_of(fit->data, spacing, unit);
  const double edge = 0.015 + 1e-5;
  const auto reaches = [&](double eta, double omega) {
    const Vector3 point = support_plane_point(planes[0], eta, omega);
    return closest_on_tile(tile, static_cast<float>(unit), planes[0], point, 2e-5F).distance <
           2e-5F;
  };
  CHECK(reaches(0.0149, 0.009));
  CHECK_FALSE(reaches(edge + 5e-5, 0.01));
  CHECK_FALSE(reaches(0.01, edge + 5e-5));
}

TEST_CASE("Tiles and pieces together stand for every point of the surface, within the tolerance") {
  const double tolerance = 1e-4;
  const test::Shape shape = test::merged(test::torus(0.02, 0.006, 60, 30),
                                         test::moved(test::box({0.01, 0.01, 0.01}), {0, 0, 0.03}));
  const Covered covered(shape, tolerance);
  CHECK(covered.counts.cells > 1000);
  const std::vector<Tile> tiles = views_of(covered.tiles);
  std::size_t open = 0;
  for (const SurfacePoint& sample : surface_points(covered.caster, 5e-4, 0, 9)) {
    double least = 1;
    for (const Tile& tile : tiles) {
      const TileClosestPoint closest_point =
          closest_on_tile(tile, static_cast<float>(unit), covered.planes[tile.plane], sample.point,
                          static_cast<float>(least));
      least = std::min(least, static_cast<double>(closest_point.distance));
    }
    if (least <= tolerance * 1.001) continue;
    ++open;
    CHECK(covered.cover.open[sample.triangle].has_value());
  }
  CHECK(open < 200);
}

TEST_CASE("No point of a proven tile is farther from the surface than the tolerance") {
  const double tolerance = 1e-4;
  const Covered covered(test::torus(0.02, 0.006, 60, 30), tolerance);
  for (const Tile& tile : views_of(covered.tiles)) {
    TileHeights heights;
    tile_heights(tile, static_cast<float>(unit), heights);
    for (std::uint32_t cell = 0; cell < tile_cell_count; ++cell) {
      if (((tile.valid & ~tile.clipped) >> cell & 1U) == 0) continue;
      const std::uint32_t column = cell % tile_cells, row = cell / tile_cells;
      const auto at = [&](std::uint32_t i, std::uint32_t j) {
        return static_cast<double>(heights[(row + j) * tile_samples + column + i]);
      };
      const double depth = tile.base + (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)) / 4;
      const auto s = static_cast<double>(tile.spacing);
      const SupportPlane& plane = covered.planes[tile.plane];
      const Vector3 middle = support_plane_point(plane, tile.eta0 + (column + 0.5) * s,
                                                 tile.omega0 + (row + 0.5) * s) -
                             depth * plane.n;
      CHECK(std::abs(covered.caster.closest(middle).distance) <= tolerance);
    }
  }
}

TEST_CASE("A tile that was moved off the surface loses its cells") {
  Covered covered(test::torus(0.02, 0.006, 60, 30), 1e-4);
  const std::size_t before = covered.tiles.size();
  REQUIRE(before > 2);
  covered.tiles[1].base += 3e-4F;
  ProofCounts counts;
  prove_tiles(covered.caster, covered.planes, covered.tiles, spacing, unit, 1e-4, {}, counts);
  CHECK(covered.tiles.size() == before - 1);
  CHECK(counts.refused_cells > 0);
}

TEST_CASE("Without tiles every triangle of a surface is open, at a place of its own") {
  const test::Shape box = test::box({0.03, 0.03, 0.03});
  const Caster caster(test::surface_of(box));
  const SurfaceCover cover = prove_surface(caster, axis_planes(0.015), {}, unit, 1e-4, {});
  CHECK(open_triangles(cover) == box.triangles.size());
  for (std::uint32_t t = 0; t < cover.open.size(); ++t) {
    REQUIRE(cover.open[t].has_value());
    const Vector3& place = *cover.open[t];
    CHECK(
        (closest_on_triangle(place, caster.corner(t, 0), caster.corner(t, 1), caster.corner(t, 2)) -
         place)
            .norm() < 1e-12);
  }
}

TEST_CASE("Trimming keeps what the proof rests on: the surface stays proven") {
  Covered covered(test::torus(0.02, 0.006, 60, 30), 1e-4);
  const std::size_t open = open_triangles(covered.cover);
  std::size_t cells = 0, kept = 0;
  for (const TileData& tile : covered.tiles)
    cells += static_cast<std::size_t>(std::popcount(tile.valid));
  std::vector<std::uint64_t> used(covered.tiles.size(), 0);
  for (const auto& uses : covered.cover.uses) {
    for (const TileUse& use : uses) used[use.tile] |= use.cells;
  }
  trim_tiles(covered.tiles, used);
  for (const TileData& tile : covered.tiles)
    kept += static_cast<std::size_t>(std::popcount(tile.valid));
  CHECK(kept < cells);
  CHECK(open_triangles(prove_surface(covered.caster, covered.planes, views_of(covered.tiles), unit,
                                     1e-4, {})) <= open);
}

TEST_CASE("Every tile near a point is in its bin") {
  const Covered covered(test::torus(0.02, 0.006, 60, 30), 1e-4);
  const std::vector<Tile> tiles = views_of(covered.tiles);
  const TileBins bins(covered.planes, tiles, static_cast<float>(unit), 0.002, 1e-4);
  for (const SurfacePoint& sample : surface_points(covered.caster, 2e-3, 0, 5)) {
    const std::span<const std::uint32_t> near = bins.near(sample.point);
    for (std::uint32_t i = 0; i < tiles.size(); ++i) {
      const TileClosestPoint closest_point =
          closest_on_tile(tiles[i], static_cast<float>(unit), covered.planes[tiles[i].plane],
                          sample.point, 9.9e-5F);
      if (!std::isfinite(closest_point.distance)) continue;
      CHECK(std::find(near.begin(), near.end(), i) != near.end());
    }
  }
}

}  // namespace
}  // namespace spm::baker::tiles_test
