// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/report/served_default.hpp"

#include <catch2/catch.hpp>

#include "common/contact/stable_stiffness.hpp"
#include "tests/stability/catalogue/catalogue_parts.hpp"

namespace spm::stability::served_default_test {
namespace {

/// A hand that presses on a plate of half a millimetre, z = 0 on top, and stays.
StabilityCase pressed_plate() {
  StabilityCase tried = press_case(
      "thin", "served-plate", "",
      test::moved(test::plate(Vector3(0.04, 0.04, 0.5e-3)), Vector3(0, 0, -0.25e-3)), {});
  tried.tolerance = 100e-6;
  tried.max_depth = 1e-3;
  tried.seeds = 2;
  return tried;
}

TEST_CASE("What is served without options holds a thin plate on every profile") {
  for (const servo::SimProfile& profile : servo::sim_profiles) {
    CAPTURE(profile.name);
    const CaseVerdict found = served_verdict(pressed_plate(), profile);
    CAPTURE(found.worst.reason);
    CHECK(found.seeds == 2);
    CHECK(found.good());
    CHECK_FALSE(found.worst.findings.popped);
  }
}

TEST_CASE("What is served is judged as the laboratory's default at the stiffness of the device") {
  const StabilityCase tried = pressed_plate();
  for (const servo::SimProfile& profile : servo::sim_profiles) {
    CAPTURE(profile.name);
    RunSettings settings;
    settings.profile = &profile;
    settings.stiffness = stable_stiffness(*find_device_profile(profile.name));
    const CaseVerdict served = served_verdict(tried, profile);
    const CaseVerdict named = case_verdict(tried, settings, {"default", {}});
    CHECK(served.good() == named.good());
    CHECK(served.worst.findings.held_n == Approx(named.worst.findings.held_n).epsilon(1e-6));
  }
}

TEST_CASE("A case of effects, or of a share of the border, is of no asset alone") {
  StabilityCase tried = pressed_plate();
  CHECK(why_not_by_default(tried).empty());
  tried.of_border = 0.6;
  CHECK_FALSE(why_not_by_default(tried).empty());
  tried.of_border = 0;
  tried.effects.friction = {0.5, 0.4, 0};
  CHECK_FALSE(why_not_by_default(tried).empty());
}

TEST_CASE("A case that cannot be prepared is told, not passed") {
  StabilityCase tried = pressed_plate();
  tried.name = "no-mesh";
  tried.mesh = "there-is-no-such-mesh.obj";
  const std::vector<ServedRow> rows = serve_all({tried});
  REQUIRE(rows.size() == servo::sim_profiles.size());
  for (const ServedRow& row : rows) {
    CHECK_FALSE(row.failure.empty());
    CHECK(row.verdict.seeds == 0);
  }
}

}  // namespace
}  // namespace spm::stability::served_default_test
