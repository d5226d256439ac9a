// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/surface_samples.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <utility>
#include <vector>

#include "tests/support/asset_by_hand.hpp"
#include "tests/support/octree_by_hand.hpp"
#include "tests/support/triangle_octree.hpp"

namespace spm::surface_samples_test {
namespace {

using test::BoxByHand;
using test::TiledCubeByHand;

constexpr double size = 0.04;

Vector3 to_vector(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

double area_of(const AssetView& asset, double step) {
  const auto patches = surface_patches(asset, step);
  REQUIRE(patches.has_value());
  double area = 0;
  for (const SurfacePatch& patch : *patches) area += static_cast<double>(patch.area);
  return area;
}

/// Shows more tiles of a cube than the six of its faces.
void add_tiles(TiledCubeByHand& cube, const std::vector<test::TileByHand>& more) {
  cube.by_hand.insert(cube.by_hand.end(), more.begin(), more.end());
  cube.refresh();
}

TEST_CASE("The pieces of a cube have its area, and lie on it with its normals") {
  const TiledCubeByHand cube(size);
  for (const double step : {0.01, 0.0021}) {
    CHECK(area_of(cube.view, step) == Approx(6 * size * size).epsilon(1e-5));
  }
  const auto patches = surface_patches(cube.view, 0.003);
  for (const SurfacePatch& patch : *patches) {
    const Vector3 position = to_vector(patch.position), normal = to_vector(patch.normal);
    REQUIRE(position.cwiseAbs().maxCoeff() == Approx(size / 2));
    REQUIRE(position.dot(normal) == Approx(size / 2));
    REQUIRE(static_cast<double>(patch.area) <= 0.003 * 0.003 * 1.0001);
  }
}

TEST_CASE("A surface that would take pieces without bound is refused before they are made") {
  TiledCubeByHand cube(size);
  cube.by_hand.clear();
  cube.octree = test::triangle_octree(test::box(Vector3::Constant(size)),
                                      {.low = cube.octree.origin, .edge = cube.octree.edge},
                                      cube.octree.lattice_step, true);
  cube.refresh();
  CHECK(sample_surface(cube.view, size / 100));
  const auto patches = surface_patches(cube.view, 1e-8);
  REQUIRE_FALSE(patches);
  CHECK(patches.error().code == ExitCode::invalid_input);
  CHECK(patches.error().message.find("give a larger spacing") != std::string::npos);
  // Corners of a broken file may lie a billion times as far apart as its octree is wide.
  cube.view.exact.step = 1e3;
  const auto samples = sample_surface(cube.view, size / 100);
  REQUIRE_FALSE(samples);
  CHECK(samples.error().code == ExitCode::invalid_input);
}

TEST_CASE("Tiles that lie anywhere, also where no number of a cube leads, are sampled") {
  TiledCubeByHand cube(size);
  std::vector<test::TileByHand> more(cube.by_hand.begin(), cube.by_hand.begin() + 2);
  more[0].tile.eta0 = 1e12;
  more[1].tile.omega0 = -1e12;
  add_tiles(cube, more);
  const auto samples = sample_surface(cube.view, size / 10);
  REQUIRE(samples);
  CHECK(samples->area == Approx(8 * size * size).epsilon(1e-3));
}

TEST_CASE("Tiles that lie on others, whole or in part, by another plane too, add no area") {
  TiledCubeByHand cube(size);
  std::vector<test::TileByHand> more(cube.by_hand.begin(), cube.by_hand.end());
  more[1].tile.base = 1.5e-5;   // within two tolerances
  more[2].tile.eta0 += 0.0123;  // half of it beyond the face, where it is not valid
  more[2].tile.valid = 0x0303030303030303U;
  add_tiles(cube, more);
  CHECK(area_of(cube.view, 0.001) == Approx(6 * size * size).epsilon(1e-5));
  cube.by_hand[7].tile.base = 2.5e-5;  // now it is a sheet of its own
  cube.refresh();
  CHECK(area_of(cube.view, 0.001) == Approx(7 * size * size).epsilon(1e-5));
}

TEST_CASE("Of two tiles that overlap in part each place is the first one's") {
  TiledCubeByHand cube(size);
  std::vector<test::TileByHand> more{cube.by_hand[0]};
  more[0].tile.eta0 += size / 8 * 2.5;
  add_tiles(cube, more);
  // Two and a half columns stand beyond the face.
  CHECK(area_of(cube.view, 0.0007) == Approx(size * size * (6 + 2.5 / 8)).epsilon(2e-3));
}

TEST_CASE("A bare triangle on a tile is the owner, and the areas stay") {
  TiledCubeByHand cube(size);
  constexpr std::int32_t half = TiledCubeByHand::half_steps;
  test::TriangleByHand triangle;
  triangle.corners = {{{half, -half, -half}, {half, half, -half}, {half, -half, half}}};
  triangle.bare = true;
  test::add_triangle(cube.octree, triangle);
  cube.refresh();
  CHECK(area_of(cube.view, 0.0005) == Approx(6 * size * size).epsilon(2e-3));
  // Alone it is half of a face; and triangles that tiles show are not counted again.
  cube.by_hand.clear();
  cube.refresh();
  CHECK(area_of(cube.view, 0.0005) == Approx(size * size / 2).epsilon(1e-5));
}

TEST_CASE("A clipped cell counts as far as its line") {
  TiledCubeByHand cube(size);
  cube.by_hand[0].tile.clipped = 1;
  cube.by_hand[0].clips = {pack_clip({100, 100, 0})};  // half of the cell
  cube.refresh();
  const double cell = size * size / 64;
  CHECK(area_of(cube.view, 0.0002) == Approx(6 * size * size - cell / 2).epsilon(2e-4));
}

TEST_CASE("Both sides of a plate thinner than the tolerance are surface") {
  TiledCubeByHand cube(size);
  for (SupportPlane& plane : cube.planes) plane.x0 *= 1e-4;
  cube.refresh();
  CHECK(area_of(cube.view, 0.002) == Approx(6 * size * size).epsilon(1e-5));
}

TEST_CASE("Levels are nested, each with the whole area, and coarser ones bound farther places") {
  const TiledCubeByHand cube(size);
  const auto samples = sample_surface(cube.view, 0.001);
  REQUIRE(samples.has_value());
  REQUIRE(samples->levels.size() > 4);
  CHECK(samples->area == Approx(6 * size * size).epsilon(1e-5));
  CHECK(samples->levels.back().spacing == 0.001);
  CHECK(samples->levels.back().count >= 9600);
  for (std::size_t k = 0; k < samples->levels.size(); ++k) {
    const SampleLevel& level = samples->levels[k];
    double area = 0;
    for (std::uint32_t i = level.first; i < level.first + level.count; ++i) {
      area += static_cast<double>(samples->shares[i].area);
      REQUIRE(samples->shares[i].normal().norm() == Approx(1));
      const SampleChildren below = samples->below(i);
      if (k + 1 == samples->levels.size()) {
        REQUIRE(below.count == 0);
        REQUIRE(samples->places[i].radius == 0);
        continue;
      }
      REQUIRE(below.count > 0);
      REQUIRE(below.first >= samples->levels[k + 1].first);
      REQUIRE(samples->places[below.first].position == samples->places[i].position);
    }
    CHECK(area == Approx(samples->area).epsilon(1e-5));
    if (k > 0) CHECK(level.bound < samples->levels[k - 1].bound);
  }
}

TEST_CASE("A sample's sphere holds all samples below it") {
  const TiledCubeByHand cube(size);
  const auto samples = sample_surface(cube.view, 0.0017);
  REQUIRE(samples.has_value());
  std::vector<std::pair<std::uint32_t, std::uint32_t>> open;
  std::uint32_t finest = 0;
  for (std::uint32_t i = 0; i < samples->levels.back().first; ++i) open.emplace_back(i, i);
  while (!open.empty()) {
    const auto [top, at] = open.back();
    open.pop_back();
    const SampleChildren below = samples->below(at);
    for (std::uint32_t k = 0; k < below.count; ++k) open.emplace_back(top, below.first + k);
    if (below.count > 0) continue;
    ++finest;
    const double off =
        (to_vector(samples->places[at].position) - to_vector(samples->places[top].position)).norm();
    REQUIRE(off <= static_cast<double>(samples->places[top].radius));
  }
  CHECK(finest > samples->levels.back().count);
}

TEST_CASE("The mean place and the spread of a sample are those of its surface") {
  TiledCubeByHand cube(size);
  const auto samples = sample_surface(cube.view, 0.0005);
  REQUIRE(samples.has_value());
  // Each of the coarsest samples stands for one face: it has the face's middle, and the variance of
  // a square, size^2 / 12 per axis.
  REQUIRE(samples->levels[0].count == 6);
  for (std::uint32_t i = 0; i < 6; ++i) {
    const Vector3 middle =
        to_vector(samples->places[i].position) + to_vector(samples->spreads[i].middle);
    CHECK((middle - size / 2 * samples->shares[i].normal()).norm() < 1e-4 * size);
    CHECK(static_cast<double>(samples->spreads[i].spread) == Approx(size / 2).epsilon(1e-3));
  }
}

TEST_CASE("A full asset, an empty one and a spacing of nothing are refused with a cure") {
  const BoxByHand box(Vector3(0.03, 0.03, 0.03));
  const auto full = sample_surface(box.view, 0.001);
  REQUIRE(!full.has_value());
  CHECK(full.error().code == ExitCode::invalid_input);
  CHECK(full.error().message.find("--form sparse") != std::string::npos);
  TiledCubeByHand cube(size);
  for (const double spacing : {0.0, -1.0, 1e-12, std::nan("")}) {
    CHECK(sample_surface(cube.view, spacing).error().code == ExitCode::usage);
  }
  cube.by_hand.clear();
  cube.refresh();
  CHECK(sample_surface(cube.view, 0.001).error().code == ExitCode::invalid_input);
}

}  // namespace
}  // namespace spm::surface_samples_test
