// SPDX-License-Identifier: Apache-2.0
#include "common/contour/line_crossings.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "common/query/query.hpp"
#include "common/surface/support_plane_mapping.hpp"
#include "tests/support/asset_by_hand.hpp"
#include "tests/support/octree_by_hand.hpp"
#include "tests/support/random.hpp"

namespace spm::line_crossings_test {
namespace {

using test::SparseCubeByHand;

constexpr double size = 0.04;
constexpr std::size_t many = 1U << 20U;

TEST_CASE("A line through a ball meets it where it enters and where it leaves") {
  SparseCubeByHand cube(size);
  constexpr double radius = 0.4 * size;
  cube.replace_triangles(test::sphere(radius, 3));
  CrossingSearch search(cube.view, many);
  test::RandomTwister random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const int axis = trial % 3;
    const Vector3 through(random.between(-0.5, 0.5) * size, random.between(-0.5, 0.5) * size,
                          random.between(-0.5, 0.5) * size);
    Vector3 across = through;
    across[axis] = 0;
    const auto& found = search.along(axis, through);
    if (std::abs(across.norm() - radius) < 0.02 * radius) continue;
    REQUIRE(found.size() == (across.norm() < radius ? 2 : 0));
    for (const SurfaceCrossing& crossing : found) {
      REQUIRE(std::abs(crossing.place.norm() - radius) < 0.01 * radius);  // facets
      REQUIRE(std::abs(query_point(cube.view, crossing.place).distance) < 1e-7);
      REQUIRE(crossing.normal.dot(crossing.place.normalized()) > 0.97);
    }
    if (found.size() == 2) CHECK(found[0].place[axis] < found[1].place[axis]);
  }
}

/// An octree of eight cubes about the origin. Their answers come from two distance maps: in those
/// below x = 0 the surface is flat across x at `below`, in the others at `above`; the solid is
/// below it.
struct TwoMaps {
  static constexpr std::uint16_t side = 8;
  std::vector<float> heights[2];
  std::vector<HeightChart> charts;
  std::vector<SupportPlane> planes{plane_with_normal(Vector3::Zero(), Vector3::UnitX())};
  std::vector<std::uint32_t> root_words{test::root_word(OctreeKind::split, 0)};
  std::vector<std::uint32_t> words{2, test::octant_kinds(OctreeKind::map)};
  AssetView view;

  TwoMaps(double below, double above) {
    for (const double place : {below, above}) {
      std::vector<float>& flat = heights[charts.size()];
      flat.assign(std::size_t{side} * side + 1, static_cast<float>(-place));
      HeightChart chart = chart_on(planes[0], size / 2, -4, -4);
      chart.heights = std::span<const float>(flat);
      chart.stride = chart.columns = chart.rows = side;
      charts.push_back(chart);
    }
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
      words.push_back(word_of_map(octant & 1U));
    }
    view.planes = planes;
    view.charts = charts;
    view.octree.origin = Vector3::Constant(-size);
    view.octree.edge = 2 * size;
    view.octree.per_edge = 0.5 / size;
    view.octree.roots = {1, 1, 1};
    view.octree.root_words = root_words;
    view.octree.words = words;
    view.band = {2 * size, 2 * size};
    view.tolerance = 1e-5;
  }
  TwoMaps(const TwoMaps&) = delete;
  TwoMaps& operator=(const TwoMaps&) = delete;
};

TEST_CASE("A surface on a border of cubes is met once, whatever the two sides tell of it") {
  for (const double below : {-9e-6, 0.0, 9e-6}) {
    for (const double above : {-9e-6, 0.0, 9e-6}) {
      CAPTURE(below, above);
      const TwoMaps two(below, above);
      CrossingSearch search(two.view, many);
      const auto& found = search.along(0, {0, 0.1 * size, 0.2 * size});
      // The line begins in the solid and ends outside.
      REQUIRE(found.size() == 1);
      CHECK(std::abs(found[0].place.x()) < 1e-5);
      CHECK(found[0].normal.x() == Approx(1));
    }
  }
}

TEST_CASE("A search ends after as many queries as it was given") {
  const SparseCubeByHand cube(size);
  CrossingSearch search(cube.view, 10);
  for (int line = 0; line < 20; ++line) {
    static_cast<void>(search.along(0, Vector3::Zero()));
  }
  CHECK(search.exhausted());
  CHECK(search.along(0, Vector3::Zero()).empty());
}

}  // namespace
}  // namespace spm::line_crossings_test
