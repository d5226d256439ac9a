// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/build/lids_report.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

namespace spm::test::lids_report_test {
namespace {

using baker::Hole;

[[nodiscard]] nlohmann::ordered_json report_of(const std::vector<Hole>& holes) {
  nlohmann::ordered_json report;
  baker::add_lids_json(holes, report);
  return report;
}

}  // namespace

TEST_CASE("A report lists the holes that lids close with place, area and border edges") {
  const auto report = report_of({{{0.01, 0.02, 0.03}, 4e-6, 12}, {{0, 0, 0}, 1e-6, 3}});
  CHECK(report["lids_total"] == 2);
  CHECK(report["lids_area_mm2"].get<double>() == Approx(5));
  REQUIRE(report["lids"].size() == 2);
  CHECK(report["lids"][0]["place"] == nlohmann::ordered_json({0.01, 0.02, 0.03}));
  CHECK(report["lids"][0]["area_mm2"].get<double>() == Approx(4));
  CHECK(report["lids"][0]["edges"] == 12);
}

TEST_CASE("A report lists a hundred lids and counts them all") {
  const auto report = report_of(std::vector<Hole>(250, {{0, 0, 0}, 1e-6, 3}));
  CHECK(report["lids"].size() == 100);
  CHECK(report["lids_total"] == 250);
  CHECK(report["lids_area_mm2"].get<double>() == Approx(250));
}

TEST_CASE("Lids are one line for a person, and none where there are none") {
  CHECK(baker::lids_text(report_of({})).empty());
  CHECK(baker::lids_text(report_of({{{0.01, -2e-16, -0.03}, 4e-6, 12}})) ==
        "lids     1 hole closed, 4 mm2 at (10, 0, -30) mm\n");
  CHECK(baker::lids_text(report_of({{{0.01, 0.02, -0.03}, 4e-6, 12}, {{0, 0, 0}, 1.5e-6, 3}})) ==
        "lids     2 holes closed, 5.5 mm2 in all; the largest 4 mm2 at (10, 20, -30) mm\n");
}

}  // namespace spm::test::lids_report_test
