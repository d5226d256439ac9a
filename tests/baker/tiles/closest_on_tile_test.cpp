// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/tiles/closest_on_tile.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "common/surface/distance_map.hpp"
#include "common/surface/support_plane_mapping.hpp"
#include "tests/support/asset_by_hand.hpp"
#include "tests/support/random.hpp"

namespace spm::baker::closest_on_tile_test {
namespace {

constexpr float unit_of_heights = 1e-6F;
constexpr double rounding = 3e-8;  ///< error of single precision at a tile's size, m

using test::RandomTwister;

SupportPlane random_plane(RandomTwister& random) {
  const Vector3 normal(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
  return plane_with_normal({0.01, -0.02, 0.03}, normal.normalized());
}

/// A wavy tile of 8 mm with some cells left out and some clipped.
test::TileByHand random_tile(RandomTwister& random) {
  const double bend = random.between(-20, 20), ridge = random.between(0, 0.3);
  test::TileByHand made =
      test::tile_by_hand(0, random.between(-0.02, 0.02), random.between(-0.02, 0.02), 1e-3F,
                         unit_of_heights, [=](double eta, double omega) {
                           return bend * (eta * eta - omega * eta) + ridge * std::abs(omega) + 0.01;
                         });
  made.tile.slope_eta = half_to_float(float_to_half(static_cast<float>(random.between(-1, 1))));
  made.tile.slope_omega = half_to_float(float_to_half(static_cast<float>(random.between(-1, 1))));
  if (random.bits() % 2 == 0) made.tile.valid = random.bits() | random.bits();
  made.tile.clipped = made.tile.valid & random.bits() & random.bits();
  for (int k = 0; k < std::popcount(made.tile.clipped); ++k) {
    made.clips.push_back(pack_clip({static_cast<float>(random.between(-127, 127)),
                                    static_cast<float>(random.between(-127, 127)),
                                    static_cast<float>(random.between(-30, 60))}));
  }
  return made;
}

/// The line of a clipped cell; for any other cell, a line that clips nothing.
Clip clip_at(const Tile& tile, std::uint32_t cell) {
  if (((tile.clipped >> cell) & 1U) == 0) return {0, 0, 1};
  const std::uint64_t before = tile.clipped & ((std::uint64_t{1} << cell) - 1);
  return unpack_clip(tile.clips[std::popcount(before)]);
}

/// Bilinear depth at a place of a cell, from -0.5 to 0.5.
double depth_at(const Tile& tile, const TileHeights& heights, std::uint32_t cell, double x,
                double y) {
  const std::uint32_t first = cell / 8 * 9 + cell % 8;
  const double near_row =
      (0.5 - x) * double{heights[first]} + (0.5 + x) * double{heights[first + 1]};
  const double far_row =
      (0.5 - x) * double{heights[first + 9]} + (0.5 + x) * double{heights[first + 10]};
  return tile.base + (0.5 - y) * near_row + (0.5 + y) * far_row;
}

/// Least distance to points all over the valid surface.
double distance_by_search(const Tile& tile, const TileHeights& heights, const SupportPlane& plane,
                          const Vector3& point) {
  constexpr int steps = 12;
  const auto spacing = static_cast<double>(tile.spacing);
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t cell = 0; cell < tile_cell_count; ++cell) {
    if (((tile.valid >> cell) & 1U) == 0) continue;
    const Clip clip = clip_at(tile, cell);
    for (int j = 0; j <= steps; ++j) {
      for (int i = 0; i <= steps; ++i) {
        const double x = static_cast<double>(i) / steps - 0.5;
        const double y = static_cast<double>(j) / steps - 0.5;
        if (double{clip.a} * x + double{clip.b} * y > double{clip.c}) continue;
        const Vector3 place = reconstructed_surface(
            plane, tile.eta0 + (cell % 8 + 0.5 + x) * spacing,
            tile.omega0 + (cell / 8 + 0.5 + y) * spacing, depth_at(tile, heights, cell, x, y));
        least = std::min(least, (place - point).norm());
      }
    }
  }
  return least;
}

double greatest_twist(const TileHeights& heights) {
  double twist = 0;
  for (std::uint32_t cell = 0; cell < tile_cell_count; ++cell) {
    const std::uint32_t first = cell / 8 * 9 + cell % 8;
    twist = std::max(twist, std::abs(double{heights[first]} - double{heights[first + 1]} -
                                     double{heights[first + 9]} + double{heights[first + 10]}));
  }
  return twist;
}

/// A point about a tile, mostly near its surface.
Vector3 point_near(RandomTwister& random, const Tile& tile, const SupportPlane& plane) {
  return reconstructed_surface(plane, tile.eta0 + random.between(-0.002, 0.010),
                               tile.omega0 + random.between(-0.002, 0.010),
                               tile.base + random.between(-0.01, 0.01));
}

}  // namespace

TEST_CASE(
    "The closest point on a tile is a point of its valid surface, as near as any but for the "
    "twist") {
  RandomTwister random(5);
  for (int trial = 0; trial < 200; ++trial) {
    const SupportPlane plane = random_plane(random);
    const test::TileByHand made = random_tile(random);
    const Tile tile = made.view(unit_of_heights);
    TileHeights heights;
    tile_heights(tile, unit_of_heights, heights);
    const double twist = greatest_twist(heights);
    const auto spacing = static_cast<double>(tile.spacing);
    for (int k = 0; k < 10; ++k) {
      const Vector3 point = point_near(random, tile, plane);
      const TileClosestPoint closest_point =
          closest_on_tile(tile, unit_of_heights, plane, point, 1.0F);
      const double least = distance_by_search(tile, heights, plane, point);
      REQUIRE(std::isfinite(closest_point.distance) == std::isfinite(least));
      if (!std::isfinite(least)) continue;
      INFO("trial " << trial << ", distance " << closest_point.distance << ", by search " << least);
      CHECK(double{closest_point.distance} <= least + twist / 2 + rounding);

      const PlaneCoordinates target = project_on_plane(plane, point);
      const double x = (target.eta - double{closest_point.away_eta} - tile.eta0) / spacing -
                       (closest_point.cell % 8 + 0.5);
      const double y = (target.omega - double{closest_point.away_omega} - tile.omega0) / spacing -
                       (closest_point.cell / 8 + 0.5);
      const Clip clip = clip_at(tile, closest_point.cell);
      CHECK(((tile.valid >> closest_point.cell) & 1U) == 1);
      CHECK(std::max(std::abs(x), std::abs(y)) <= 0.5 + 1e-4);
      CHECK(double{clip.a} * x + double{clip.b} * y <= double{clip.c} + 0.02);
      CHECK(depth_at(tile, heights, closest_point.cell, x, y) ==
            Approx(target.depth - double{closest_point.away_depth}).margin(rounding));
    }
  }
}

TEST_CASE("A closest point that is no nearer than the limit is none") {
  RandomTwister random(6);
  for (int trial = 0; trial < 500; ++trial) {
    const SupportPlane plane = random_plane(random);
    const test::TileByHand made = random_tile(random);
    const Tile tile = made.view(unit_of_heights);
    const Vector3 point = point_near(random, tile, plane);
    const TileClosestPoint closest_point =
        closest_on_tile(tile, unit_of_heights, plane, point, 1.0F);
    if (!std::isfinite(closest_point.distance)) continue;
    const auto with_limit = [&](float limit) {
      return closest_on_tile(tile, unit_of_heights, plane, point, limit).distance;
    };
    CHECK(with_limit(closest_point.distance * 1.001F + 1e-7F) == closest_point.distance);
    CHECK(std::isinf(with_limit(closest_point.distance * 0.999F)));
  }
}

TEST_CASE("Points that are not finite have no closest point") {
  RandomTwister random(8);
  const SupportPlane plane = random_plane(random);
  const test::TileByHand made = random_tile(random);
  const Tile tile = made.view(unit_of_heights);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double wrong : {nan, std::numeric_limits<double>::infinity(), 1e300}) {
    const TileClosestPoint closest_point =
        closest_on_tile(tile, unit_of_heights, plane, {0, wrong, 0}, 1.0F);
    CHECK(std::isinf(closest_point.distance));
  }
}

}  // namespace spm::baker::closest_on_tile_test
