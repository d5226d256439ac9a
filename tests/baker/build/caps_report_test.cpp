// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/build/caps_report.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

namespace spm::test::caps_report_test {
namespace {

using baker::CappedHole;

[[nodiscard]] nlohmann::ordered_json report_of(const std::vector<CappedHole>& holes) {
  nlohmann::ordered_json report;
  baker::add_caps_json(holes, report);
  return report;
}

}  // namespace

TEST_CASE("A report lists capped holes with place, area and border edges") {
  const auto report = report_of({{{0.01, 0.02, 0.03}, 4e-6, 12}, {{0, 0, 0}, 1e-6, 3}});
  CHECK(report["caps_total"] == 2);
  CHECK(report["caps_area_mm2"].get<double>() == Approx(5));
  REQUIRE(report["caps"].size() == 2);
  CHECK(report["caps"][0]["place"] == nlohmann::ordered_json({0.01, 0.02, 0.03}));
  CHECK(report["caps"][0]["area_mm2"].get<double>() == Approx(4));
  CHECK(report["caps"][0]["edges"] == 12);
}

TEST_CASE("A report lists a hundred capped holes and counts them all") {
  const auto report = report_of(std::vector<CappedHole>(250, {{0, 0, 0}, 1e-6, 3}));
  CHECK(report["caps"].size() == 100);
  CHECK(report["caps_total"] == 250);
  CHECK(report["caps_area_mm2"].get<double>() == Approx(250));
}

TEST_CASE("Capped holes are one line for a person, and none where there are none") {
  CHECK(baker::caps_text(report_of({})).empty());
  CHECK(baker::caps_text(report_of({{{0.01, -2e-16, -0.03}, 4e-6, 12}})) ==
        "caps     1 hole closed for the side only, 4 mm2 at (10, 0, -30) mm\n");
  CHECK(baker::caps_text(report_of({{{0.01, 0.02, -0.03}, 4e-6, 12}, {{0, 0, 0}, 1.5e-6, 3}})) ==
        "caps     2 holes closed for the side only, 5.5 mm2 in all; the largest 4 mm2 at "
        "(10, 20, -30) mm\n");
}

}  // namespace spm::test::caps_report_test
