// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/report/stability_targets.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <string>

namespace spm::stability::stability_targets_test {
namespace {

CaseRow gentle_run(const std::string& name, const std::string& device, bool is_good,
                   double generated = 0, double bound = 1e-4) {
  CaseRow row;
  row.name = name;
  row.method = "default";
  row.device = device;
  row.fraction = 0.6;
  row.verdict.good = is_good;
  row.verdict.bad = !is_good;
  row.verdict.findings.generated_j = generated;
  row.verdict.findings.generated_bound_j = bound;
  return row;
}

/// The row whose name begins with this text; the test fails where there is none.
TargetRow row_of(const StabilityReport& report, const std::string& begin) {
  for (const TargetRow& row : targets_of(report)) {
    if (row.name.starts_with(begin)) return row;
  }
  FAIL("no target begins with " << begin);
  return {};
}

bool has_row(const StabilityReport& report, const std::string& begin) {
  for (const TargetRow& row : targets_of(report)) {
    if (row.name.starts_with(begin)) return true;
  }
  return false;
}

TEST_CASE("All that failed at 0.6 is listed, by case, however much it is") {
  StabilityReport report;
  for (int i = 0; i < 60; ++i) {
    const std::string name = "a-case-with-a-long-name-" + std::to_string(i);
    report.cases.push_back(gentle_run(name, "low", false));
    report.cases.push_back(gentle_run(name, "touch", i % 2 == 0));
  }
  report.cases.push_back(gentle_run("the-good-one", "low", true));
  const TargetRow pairs = row_of(report, "default good at 0.6, of cases and profiles");
  CHECK(pairs.value == Approx(31.0 / 121));
  CHECK(pairs.worst.find("a-case-with-a-long-name-58 (low)") != std::string::npos);
  CHECK(pairs.worst.find("a-case-with-a-long-name-59 (low, touch)") != std::string::npos);
  CHECK(pairs.worst.find("the-good-one") == std::string::npos);
  const TargetRow everywhere = row_of(report, "default good at 0.6 on every profile");
  CHECK(everywhere.value == Approx(1.0 / 61));
  CHECK(everywhere.worst.ends_with("a-case-with-a-long-name-59"));
}

TEST_CASE("Tools of six degrees have a share of their own, with torque and without") {
  StabilityReport report;
  report.cases.push_back(gentle_run("flat-wall", "low", false));
  for (const bool torque : {true, false}) {
    report.cases.push_back(gentle_run("peg-in-hole", "touch", torque));
    report.cases.back().degrees = 6;
    report.cases.back().torque = torque;
  }
  const TargetRow tools = row_of(report, "tools of six degrees good at 0.6");
  CHECK(tools.value == Approx(0.5));
  CHECK(tools.floor == 0.95);
  CHECK(tools.worst == "peg-in-hole (touch without torque)");
  CHECK(row_of(report, "default good at 0.6, of cases and profiles").worst ==
        "flat-wall (low), peg-in-hole (touch without torque)");
}

TEST_CASE("The net energy of good runs is told apart from that of all") {
  StabilityReport report;
  report.cases = {gentle_run("quiet", "low", true, 1.5e-4), gentle_run("calm", "low", true, 1e-5),
                  gentle_run("buzzing", "touch", false, 9e-3)};
  const TargetRow good = row_of(report, "net energy of the default at 0.6, of its bound, good");
  CHECK(good.value == Approx(1.5));
  CHECK(good.worst == "quiet, low");
  const TargetRow all = row_of(report, "net energy of the default at 0.6, of its bound, all");
  CHECK(all.value == Approx(90));
  CHECK(all.worst == "buzzing, touch");
}

TEST_CASE("At 1 N/mm the run that makes most energy decides, and its floor is twice its bound") {
  StabilityReport report;
  CHECK_FALSE(has_row(report, "net energy of the default at 1 N/mm"));
  for (const double joules : {2e-4, 3e-3, 1e-3}) {
    EnergyRow row;
    row.name = joules > 2e-3 ? "most" : "less";
    row.device = "omega3";
    row.verdict.findings.generated_j = joules;
    row.verdict.findings.generated_bound_j = 1e-3;
    report.energies.push_back(row);
  }
  const TargetRow row = row_of(report, "net energy of the default at 1 N/mm");
  CHECK(row.value == Approx(3e-3));
  CHECK(row.floor == Approx(2e-3));
  CHECK(row.goal == Approx(1e-3));
  CHECK_FALSE(row.meets(row.floor));
  CHECK(row.worst.starts_with("most, omega3"));
}

BorderRow border(const std::string& name, const std::string& method, const std::string& device,
                 double newtons_a_metre) {
  return {name, method, device, 3, newtons_a_metre, 2000};
}

TEST_CASE("Where the exact penalty has no border the sphere's ratio is a bound, and says so") {
  StabilityReport report;
  report.borders = {border("sphere-in-corner", "default", "low", 2200),
                    border("sphere-in-corner", "exact-penalty", "low", 500)};
  const TargetRow measured = row_of(report, "sphere in groove and corner");
  CHECK(measured.value == Approx(4.4));
  CHECK(measured.worst.find("at least") == std::string::npos);
  report.borders[1].border = 0;
  const TargetRow bound = row_of(report, "sphere in groove and corner");
  CHECK(bound.value == Approx(2200 / (min_border_share * 2000)));
  CHECK(bound.worst.find("at least") != std::string::npos);
}

TEST_CASE("The default's borders are held against bare proxy on every profile") {
  StabilityReport report;
  report.borders = {
      border("flat-wall", "default", "low", 3000), border("flat-wall", "proxy", "low", 2000),
      border("flat-wall", "default", "touch", 1500), border("flat-wall", "proxy", "touch", 2000),
      border("flat-wall", "proxy+damping", "low", 2400)};
  const TargetRow product = row_of(report, "border of the default over bare proxy");
  CHECK(product.value == Approx(0.75));
  CHECK(product.worst == "flat-wall, touch");
  const TargetRow stabilizer = row_of(report, "border with one stabilizer over without");
  CHECK(stabilizer.value == Approx(1.2));
  CHECK(stabilizer.worst == "proxy+damping, flat-wall, low");
}

TEST_CASE("The row of static loops says what the object was baked to") {
  StabilityReport report;
  report.loops = {{"galleon.obj", "spm", 100e-6, 7e-5, 1e-7, 40},
                  {"teeth.obj", "spm", 50e-6, 3e-5, 1e-7, 40}};
  CHECK(row_of(report, "static loop energy").worst == "galleon.obj, baked to 100 um");
}

TEST_CASE("Parts that are named are kept and no others, and without a name all are") {
  StabilityPlan plan;
  keep_parts(plan, {});
  CHECK((plan.borders && plan.theory && plan.loops && plan.maps && plan.costs));
  keep_parts(plan, {"costs", "theory"});
  CHECK((plan.theory && plan.costs));
  CHECK_FALSE((plan.borders || plan.loops || plan.maps));
  make_quick(plan);
  CHECK_FALSE(plan.costs);
  keep_parts(plan, {"costs"});
  CHECK(plan.costs);
}

}  // namespace
}  // namespace spm::stability::stability_targets_test
