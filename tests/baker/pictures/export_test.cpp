// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/pictures/export.hpp"

#include <catch2/catch.hpp>

#include "baker/pictures/picture.hpp"
#include "common/surface/support_plane_mapping.hpp"
#include "formats/asset/asset.hpp"
#include "tests/support/octree_by_hand.hpp"

namespace export_test {

namespace {

using namespace spm;
using namespace spm::baker;

/// A level tile of 8 mm, 2 mm below a plane at z = 10 mm, that lacks its last cell and half of its
/// first; and two triangles, one of them a cap.
Asset tile_asset() {
  Asset asset;
  asset.metadata.options = "{}";
  asset.metadata.tile_spacing = 1e-3;
  asset.metadata.height_unit = 1e-6;
  asset.planes = {plane_with_normal({0, 0, 0.01}, Vector3::UnitZ())};
  TileData tile;
  tile.base = 0.001F;
  tile.heights.fill(float_to_half(1000));
  tile.valid = ~std::uint64_t{0} >> 1U;
  tile.clipped = 1;
  tile.clips = {pack_clip({100, 0, 0})};
  asset.tiles = {tile};
  // One triangle that no tile shows, and one that a tile shows.
  test::set_lattice(asset.octree, Vector3::Zero(), 1e-6);
  test::add_triangle(asset.octree,
                     {.corners = {{{0, 0, 0}, {2000, 0, 0}, {0, 2000, 0}}}, .bare = true});
  test::add_triangle(asset.octree, {.corners = {{{0, 0, 9}, {9, 0, 9}, {0, 9, 9}}}});
  return asset;
}

}  // namespace

TEST_CASE("The surface of an asset is its tiles' valid cells up to their clips, and triangles") {
  const Asset asset = tile_asset();
  const KnownSurface surface = known_surface(tables_of(asset).view());
  double tile_area = 0, triangle_area = 0;
  for (const auto& triangle : surface.triangles) {
    std::array<Vector3, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& [x, y, z] = surface.vertices[triangle[i]];
      corners[i] = Vector3(x, y, z);
    }
    const Vector3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]) / 2;
    CHECK(normal.z() > 0);
    if (corners[0].z() > 1e-3) {
      CHECK(corners[0].z() == Approx(0.008));
      tile_area += normal.norm();
    } else {
      triangle_area += normal.norm();
    }
  }
  CHECK(tile_area == Approx(62.5e-6));
  CHECK(triangle_area == Approx(2e-6));
  CHECK(surface.vertices.size() == 79 + 4 + 3);  // clipped cells have corners of their own
}

TEST_CASE("The picture of a plane shows its tiles' valid cells up to their clips") {
  const Asset asset = tile_asset();
  const Picture picture = plane_picture(tables_of(asset).view(), 0, 80);
  REQUIRE(picture.width == 80);
  REQUIRE(picture.height == 80);
  const auto shown = [&picture](std::uint32_t x, std::uint32_t y) {
    return picture.pixels[3 * (y * picture.width + x)] != 40;
  };
  CHECK(shown(40, 40));
  CHECK(!shown(75, 5));  // the last cell
  CHECK(shown(2, 75));   // the first, on the valid side of its line
  CHECK(!shown(8, 75));  // and beyond it
  CHECK(shown(12, 75));
}

}  // namespace export_test
