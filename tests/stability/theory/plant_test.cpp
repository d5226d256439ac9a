// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/stability/theory/theory_check.hpp"

namespace plant_test {

using namespace spm::stability;

TEST_CASE("The plant's linear border is that of the exact eigenvalue to 0.2 %") {
  const std::vector<TheoryRow> rows = validate_plant(40, 20);
  REQUIRE(rows.size() == 40);
  for (const TheoryRow& row : rows) {
    CAPTURE(row.settings, row.expected, row.measured);
    CHECK(std::abs(row.off()) < 0.002);
  }
}

TEST_CASE("A border that is searched for in the wrong place is not found") {
  const SampledLoop loop = drawn_loops(1, 1).front();
  REQUIRE(std::isnan(simulated_border(loop, 1.5 * loop.stiffness)));
  REQUIRE(std::isnan(simulated_border(loop, 0.6 * loop.stiffness)));
  REQUIRE(std::abs(simulated_border(loop, 1.1 * loop.stiffness) / loop.stiffness - 1) < 0.002);
}

}  // namespace plant_test
