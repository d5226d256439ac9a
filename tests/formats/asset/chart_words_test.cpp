// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/chart_words.hpp"

#include <catch2/catch.hpp>
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

TEST_CASE("Charts survive the way through words") {
  ChartData chart;
  chart.plane = 19;
  chart.level = 3;
  chart.column0 = -70000;
  chart.row0 = 12;
  chart.columns = 900;
  chart.rows = 7;
  chart.first = 123456;
  const std::vector<ChartData> read = read_charts(words_of({ChartData(), chart}));
  REQUIRE(read.size() == 2);
  CHECK(read[1].plane == 19);
  CHECK(read[1].level == 3);
  CHECK(read[1].column0 == -70000);
  CHECK(read[1].row0 == 12);
  CHECK(read[1].columns == 900);
  CHECK(read[1].rows == 7);
  CHECK(read[1].first == 123456);
}

}  // namespace spm::chart_words_test
