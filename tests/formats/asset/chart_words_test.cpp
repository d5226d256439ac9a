// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/chart_words.hpp"

#include <catch2/catch.hpp>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace spm::chart_words_test {

TEST_CASE("A chart that does not lie in its picture is told") {
  ChartData chart;
  chart.columns = chart.rows = 4;
  CHECK(chart_problem(chart, 1, 4, 17).empty());
  // One more height may be read behind the last.
  CHECK_FALSE(chart_problem(chart, 1, 4, 16).empty());
  CHECK_FALSE(chart_problem(chart, 0, 4, 17).empty());
  CHECK_FALSE(chart_problem(chart, 1, 3, 17).empty());
  chart.columns = 2;
  CHECK_FALSE(chart_problem(chart, 1, 4, 17).empty());
}

TEST_CASE("A chart that begins too far from its plane's origin for its word is told") {
  ChartData chart;
  chart.columns = chart.rows = 4;
  for (std::int32_t ChartData::*const begin : {&ChartData::column0, &ChartData::row0}) {
    for (const std::int32_t end : {-0x8000, 0x7FFF}) {
      chart.*begin = end;
      CHECK(chart_problem(chart, 1, 4, 17).empty());
      chart.*begin = end + (end < 0 ? -1 : 1);
      CHECK(chart_problem(chart, 1, 4, 17) == "begins too far from its plane's origin");
    }
    chart.*begin = 0;
  }
}

TEST_CASE("A base that is no depth is told") {
  ChartData chart;
  chart.columns = chart.rows = 4;
  for (const float base :
       {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    chart.base = base;
    CHECK(chart_problem(chart, 1, 4, 17) == "has a base that is no depth");
  }
}

TEST_CASE("Charts survive the way through words") {
  ChartData chart;
  chart.plane = 19;
  chart.level = 3;
  chart.column0 = -32000;
  chart.row0 = 12;
  chart.columns = 900;
  chart.rows = 7;
  chart.first = 123456;
  chart.base = 0.0123F;
  const std::vector<ChartData> read = read_charts(words_of({ChartData(), chart}));
  REQUIRE(read.size() == 2);
  CHECK(read[1].plane == 19);
  CHECK(read[1].level == 3);
  CHECK(read[1].column0 == -32000);
  CHECK(read[1].row0 == 12);
  CHECK(read[1].columns == 900);
  CHECK(read[1].rows == 7);
  CHECK(read[1].first == 123456);
  CHECK(read[1].base == 0.0123F);
}

TEST_CASE("Whether a chart is of the offset surface survives the way through words") {
  ChartData of_surface, of_offset;
  of_surface.plane = of_offset.plane = max_chart_planes - 1;
  of_surface.level = of_offset.level = max_chart_levels - 1;
  of_offset.offset = true;
  const std::vector<ChartData> read = read_charts(words_of({of_offset, of_surface}));
  REQUIRE(read.size() == 2);
  CHECK(read[0].offset);
  CHECK_FALSE(read[1].offset);
  for (const ChartData& chart : read) {
    CHECK(chart.plane == max_chart_planes - 1);
    CHECK(chart.level == max_chart_levels - 1);
  }
}

TEST_CASE("Only a chart of the offset surface lies off the surface") {
  AtlasData atlas;
  atlas.spacing = 1e-3;
  atlas.offset = -0.0015;
  ChartData chart;
  CHECK(chart_over(chart, SupportPlane(), atlas, {}).offset == 0);
  chart.offset = true;
  CHECK(chart_over(chart, SupportPlane(), atlas, {}).offset == -0.0015F);
}

}  // namespace spm::chart_words_test
