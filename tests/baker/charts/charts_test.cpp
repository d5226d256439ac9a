// SPDX-License-Identifier: GPL-3.0-or-later
// Charts of a surface, their heights, the bounds of what they tell, and the picture of all heights.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>
#include <vector>

#include "baker/charts/atlas.hpp"
#include "baker/charts/chart_field.hpp"
#include "baker/charts/chart_heights.hpp"
#include "baker/charts/chart_hits.hpp"
#include "baker/charts/plane_charts.hpp"
#include "baker/planes/hull.hpp"
#include "baker/planes/planes.hpp"
#include "common/base/random.hpp"
#include "common/surface/support_plane_mapping.hpp"
#include "formats/asset/chart_words.hpp"
#include "tests/baker/pipeline/bake_support.hpp"

namespace spm::baker::charts_test {
namespace {

struct Charted {
  OuterSurface surface;
  Caster caster;
  std::vector<SupportPlane> planes;
  PlaneCharts charts;
  ChartHeights heights;

  explicit Charted(const test::Shape& shape, double spacing = 1e-3, double reach = 3e-3,
                   bool halves = false)
      : surface(test::surface_of(shape)),
        caster(surface),
        planes(vertex_based_planes(convex_hull(shape.vertices), 20)),
        charts(surface, planes, reach),
        heights(caster, surface, planes, charts,
                {.coarsest = spacing,
                 .curved = 0,
                 .levels = 3,
                 .halves = halves,
                 .offset = -2e-3,
                 .offset_levels = 3}) {}

  [[nodiscard]] Vector3 normal(std::uint32_t triangle) const {
    const auto& t = surface.triangles[triangle];
    const Vector3& a = surface.vertices[t[0]];
    return (surface.vertices[t[1]] - a).cross(surface.vertices[t[2]] - a).normalized();
  }
};

test::Shape rough(test::Shape shape, double by) {
  for (std::size_t i = 0; i < shape.vertices.size(); ++i) {
    shape.vertices[i] *= 1 + by * (random_unit(8, i) - 0.5);
  }
  return shape;
}

/// Cubes that a chart covers, near the surface.
struct CoveredCube {
  ChartAtLevel at;
  Vector3 middle;
  double half;
};

std::vector<CoveredCube> covered_cubes(const Charted& made, std::size_t count) {
  std::vector<CoveredCube> cubes;
  for (std::uint64_t i = 0; i < 50 * count && cubes.size() < count; ++i) {
    const auto t = static_cast<std::uint32_t>(random_unit(4, 4 * i) *
                                              static_cast<double>(made.surface.solid_count));
    const auto on = made.charts.charts_of(t);
    if (on.empty()) continue;
    const std::uint32_t chart =
        on[static_cast<std::size_t>(random_unit(4, 4 * i + 1) * static_cast<double>(on.size()))];
    const auto level = static_cast<std::uint32_t>(3 * random_unit(4, 4 * i + 2));
    const double half = 1e-3 * std::exp2(-5 * random_unit(4, 4 * i + 3));
    const auto& numbers = made.surface.triangles[t];
    const Vector3 middle =
        made.surface.vertices[numbers[0]] + 1e-3 * (2 * random_unit(6, i) - 1.5) * made.normal(t);
    const ChartAtLevel at{chart, level, random_unit(5, i) < 0.3};
    if (ChartField(made.heights, at).covers(middle, half)) cubes.push_back({at, middle, half});
  }
  return cubes;
}

Vector3 place_in(const CoveredCube& cube, std::uint64_t i) {
  return cube.middle + cube.half * Vector3(2 * random_unit(9, 3 * i) - 1,
                                           2 * random_unit(9, 3 * i + 1) - 1,
                                           2 * random_unit(9, 3 * i + 2) - 1);
}

}  // namespace

TEST_CASE("Each face of a box is a chart of the plane that faces it most, and goes over no edge") {
  const Charted made(test::box({0.02, 0.01, 0.03}));
  for (std::uint32_t t = 0; t < made.surface.solid_count; ++t) {
    const auto best =
        static_cast<std::uint32_t>(support_plane_mapping(made.planes, made.normal(t)));
    bool found = false;
    for (const std::uint32_t chart : made.charts.charts_of(t)) {
      const PlaneChart& known = made.charts.charts()[chart];
      found = found || known.plane == best;
      CHECK(known.triangles.size() == 2);
      for (const std::uint32_t other : known.triangles) {
        CHECK(made.normal(other).dot(made.normal(t)) > 0.999);
      }
    }
    CHECK(found);
  }
}

TEST_CASE("A smooth shape is charted whole, and charts go on over what other planes see better") {
  const Charted made(test::sphere(0.01, 4));
  std::size_t twice = 0;
  for (std::uint32_t t = 0; t < made.surface.solid_count; ++t) {
    REQUIRE_FALSE(made.charts.charts_of(t).empty());
    twice += made.charts.charts_of(t).size() > 1 ? 1 : 0;
    for (const std::uint32_t chart : made.charts.charts_of(t)) {
      const auto& triangles = made.charts.charts()[chart].triangles;
      CHECK(std::binary_search(triangles.begin(), triangles.end(), t));
      CHECK(made.planes[made.charts.charts()[chart].plane].n.dot(made.normal(t)) > 0.5);
    }
  }
  CHECK(twice > made.surface.solid_count / 2);
}

TEST_CASE("Heights of a flat face are its depth below the plane, past its border too") {
  const Charted made(test::box({0.02, 0.01, 0.03}));
  for (std::uint32_t chart = 0; chart < made.charts.charts().size(); ++chart) {
    const PlaneChart& known = made.charts.charts()[chart];
    const SupportPlane& plane = made.planes[known.plane];
    const std::uint32_t t = known.triangles.front();
    const Vector3 normal = made.normal(t),
                  corner = made.surface.vertices[made.surface.triangles[t][0]];
    const HeightGrid& grid = made.heights.of({chart, 1});
    CHECK(grid.spacing == 5e-4);
    std::size_t told = 0;
    for (std::uint32_t row = 0; row < grid.rows; ++row) {
      for (std::uint32_t column = 0; column < grid.columns; ++column) {
        const double height =
            static_cast<double>(grid.at(column, row)) + static_cast<double>(grid.base);
        if (std::isnan(height)) continue;
        ++told;
        const Vector3 on = support_plane_point(plane, grid.spacing * (grid.column0 + int(column)),
                                               grid.spacing * (grid.row0 + int(row)));
        const double depth = normal.dot(on - corner) / normal.dot(plane.n);
        CHECK(height == Approx(depth).margin(1e-7));
      }
    }
    CHECK(told > std::size_t{grid.columns} * grid.rows / 2);
  }
}

TEST_CASE(
    "A flat chart is tried at the coarsest level alone, others from where curved ones begin") {
  const test::Shape box = test::box({0.02, 0.01, 0.03}), bent = rough(test::sphere(0.02, 3), 0.01);
  for (const bool flat : {true, false}) {
    const OuterSurface surface = test::surface_of(flat ? box : bent);
    const Caster caster(surface);
    const std::vector<SupportPlane> planes =
        vertex_based_planes(convex_hull(flat ? box.vertices : bent.vertices), 20);
    const PlaneCharts charts(surface, planes, 3e-3);
    const ChartHeights heights(caster, surface, planes, charts,
                               {.coarsest = 0.016,
                                .curved = 4,
                                .levels = 6,
                                .flat_within = 1e-7,
                                .offset = -1e-3,
                                .offset_levels = 5});
    for (std::uint32_t chart = 0; chart < charts.charts().size(); ++chart) {
      if (charts.charts()[chart].triangles.size() < 2) continue;
      CHECK(heights.first_level(chart, false) == (flat ? 0 : 4));
      CHECK(heights.end_level(chart, false) == (flat ? 1 : 6));
      CHECK(heights.first_level(chart, true) == 4);
      CHECK(heights.end_level(chart, true) == 5);
      if (flat) CHECK(heights.of({.chart = chart}).heights.size() <= 144);
    }
  }
}

TEST_CASE("Deep in a rough ball the offset surface tells the distance better than the surface") {
  const Charted made(rough(test::sphere(0.02, 4), 2e-3), 2e-3, 6e-3);
  std::array<double, 2> sum{};
  std::size_t count = 0;
  for (std::uint32_t t = 0; t < made.surface.solid_count; t += 7) {
    const Vector3 foot = made.surface.vertices[made.surface.triangles[t][0]];
    const Vector3 place = foot * (1 - 2e-3 / foot.norm());
    for (const std::uint32_t chart : made.charts.charts_of(t)) {
      const ChartField of_surface(made.heights, {.chart = chart, .level = 1});
      const ChartField of_offset(made.heights, {.chart = chart, .level = 1, .offset = true});
      if (!of_surface.covers(place, 1e-5) || !of_offset.covers(place, 1e-5)) continue;
      const double truth = made.caster.closest(place).distance;
      Vector3 normal;
      sum[0] += std::abs(of_surface.at(place, normal) - truth);
      sum[1] += std::abs(of_offset.at(place, normal) - truth);
      ++count;
    }
  }
  REQUIRE(count > 100);
  CHECK(sum[1] < 0.7 * sum[0]);
  CHECK(sum[1] < 2e-5 * static_cast<double>(count));
}

TEST_CASE("Hits of an offset surface lie on it, and go on past the chart") {
  const Charted ball(test::sphere(0.02, 5), 2e-3, 1e-3);
  const PlaneChart& chart = ball.charts.charts()[0];
  const SupportPlane& plane = ball.heights.plane(0);
  ChartHits on(ball.surface, plane, chart, 1e-3), below(ball.surface, plane, chart, 1e-3);
  below.go_to_offset(ball.caster, -4e-3);
  const auto count = [](const ChartHits& hits) {
    std::size_t found = 0;
    for (std::uint32_t row = 0; row < hits.rows; ++row) {
      for (std::uint32_t column = 0; column < hits.columns; ++column) {
        found += std::isnan(hits.at(column, row)) ? 0U : 1U;
      }
    }
    return found;
  };
  CHECK(count(below) > count(on) + 10);
  for (std::uint32_t row = 0; row < below.rows; ++row) {
    for (std::uint32_t column = 0; column < below.columns; ++column) {
      const double depth = static_cast<double>(below.at(column, row));
      if (std::isnan(depth)) continue;
      const Vector3 place =
          support_plane_point(plane, 1e-3 * (below.column0 + static_cast<double>(column)),
                              1e-3 * (below.row0 + static_cast<double>(row))) -
          depth * plane.n;
      CHECK(ball.caster.closest(place).distance == Approx(-4e-3).margin(1e-6));
    }
  }
}

TEST_CASE("A chart of a ball tells the distance to it, the better the finer it is") {
  const Charted made(test::sphere(0.02, 6), 4e-3, 6e-3);
  std::array<double, 3> most{};
  std::size_t judged = 0;
  for (const CoveredCube& cube : covered_cubes(made, 500)) {
    const Vector3& place = cube.middle;
    Vector3 normal;
    const double told = ChartField(made.heights, cube.at).at(place, normal);
    const double truth = place.norm() - 0.02;
    CHECK(normal.normalized().dot(place.normalized()) > 0.97);
    if (cube.at.offset || std::abs(truth) > 2e-4) continue;
    ++judged;
    most[cube.at.level] = std::max(most[cube.at.level], std::abs(told - truth));
  }
  REQUIRE(judged > 30);
  CHECK(most[0] < 2e-4);
  CHECK(most[2] < 2e-5);
}

TEST_CASE("Nowhere in a cube does a chart leave its bounds") {
  for (const test::Shape& shape :
       {test::sphere(0.01, 4), rough(test::sphere(0.01, 4), 5e-3), test::torus(0.01, 0.003, 40, 20),
        rough(test::torus(0.01, 0.003, 80, 40), 2e-2)}) {
    const Charted made(shape);
    const std::vector<CoveredCube> cubes = covered_cubes(made, 400);
    REQUIRE(cubes.size() > 100);
    for (const CoveredCube& cube : cubes) {
      const ChartField field(made.heights, cube.at);
      const FieldBound bound = field.about(cube.middle, cube.half);
      Vector3 normal;
      CHECK(bound.near.value == Approx(field.at(cube.middle, normal)).margin(1e-12));
      for (std::uint64_t i = 0; i < 50; ++i) {
        const Vector3 place = place_in(cube, i);
        const double off = std::abs(field.at(place, normal) - bound.near.at(place));
        REQUIRE(off <= bound.off + 1e-12);
      }
    }
  }
}

TEST_CASE("What a query tells of a chart is what was bounded, to the rounding of floats") {
  const bool halves = GENERATE(false, true);
  const Charted made(rough(test::sphere(0.01, 4), 5e-3), 1e-3, 3e-3, halves);
  const std::vector<CoveredCube> cubes = covered_cubes(made, 300);
  Atlas atlas(made.heights);
  for (const CoveredCube& cube : cubes) atlas.need(cube.at, cube.middle, cube.half);
  std::vector<SupportPlane> planes;
  const AtlasData data = atlas.lay_out(planes);
  std::vector<HeightChart> charts;
  for (const ChartData& chart : data.charts) {
    REQUIRE(chart_problem(chart, planes.size(), data.width, data.heights.size()).empty());
    charts.push_back(
        chart_over(chart, planes[chart.plane], data, std::span<const float>(data.heights)));
  }
  for (const CoveredCube& cube : cubes) {
    const ChartField field(made.heights, cube.at);
    const HeightChart& chart = charts[atlas.number(cube.at, cube.middle, cube.half)];
    for (std::uint64_t i = 0; i < 30; ++i) {
      const Vector3 place = place_in(cube, i);
      Vector3 normal;
      const double bounded = field.at(place, normal);
      MapContact contact;
      REQUIRE(contact_on(chart, place, contact));
      const double told =
          static_cast<double>(chart.offset) - contact.penetration / contact.normal.norm();
      CHECK(told == Approx(bounded).margin(5e-9));
      CHECK((contact.normal - normal).norm() < 1e-4);
    }
  }
}

TEST_CASE("In the picture no height belongs to two charts, and little of it is empty") {
  const Charted made(test::torus(0.02, 0.005, 80, 40), 1e-3);
  Atlas atlas(made.heights);
  const std::vector<CoveredCube> cubes = covered_cubes(made, 2000);
  std::set<std::pair<ChartAtLevel, std::pair<std::int64_t, std::int64_t>>> wanted;
  for (const CoveredCube& cube : cubes) {
    atlas.need(cube.at, cube.middle, cube.half);
    const HeightRange range = ChartField(made.heights, cube.at).range_over(cube.middle, cube.half);
    for (std::int64_t row = range.row_from; row <= range.row_to; ++row) {
      for (std::int64_t column = range.column_from; column <= range.column_to; ++column) {
        wanted.insert({cube.at, {column, row}});
      }
    }
  }
  std::vector<SupportPlane> planes;
  const AtlasData data = atlas.lay_out(planes);
  CHECK(planes.size() <= made.planes.size());
  CHECK(data.heights.size() % data.width == 0);
  CHECK(data.heights.size() >= wanted.size());
  CHECK(static_cast<double>(wanted.size()) > 0.6 * static_cast<double>(data.heights.size()));
}

}  // namespace spm::baker::charts_test
