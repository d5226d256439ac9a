// SPDX-License-Identifier: Apache-2.0
#include "servo/force_choice.hpp"

#include <catch2/catch.hpp>

using namespace spm;
using namespace spm::servo;

TEST_CASE("The paper's method with a ball is a usage error") {
  ForceSettings settings;
  settings.method = Method::paper;
  settings.probe_radius = 1e-3;
  const auto checked = check_settings(settings);
  REQUIRE_FALSE(checked);
  REQUIRE(checked.error().code == ExitCode::usage);
}

TEST_CASE("A stiffness that is no such thing is a usage error") {
  for (const double stiffness : {-1.0, 1e9, std::nan("")}) {
    ForceSettings settings;
    settings.stiffness = stiffness;
    REQUIRE(check_settings(settings).error().code == ExitCode::usage);
  }
}

TEST_CASE("The paper's method on a sparse asset exits 3 and names the cure") {
  ForceSettings settings;
  settings.method = Method::paper;
  AssetMetadata asset;
  const auto checked = check_asset(asset, settings, "duck.spm.exr");
  REQUIRE_FALSE(checked);
  REQUIRE(checked.error().code == ExitCode::invalid_input);
  REQUIRE(checked.error().message.find("--form full") != std::string::npos);
  asset.form = AssetForm::full;
  REQUIRE(check_asset(asset, settings, "duck.spm.exr"));
}

TEST_CASE("A probe larger than the asset's exits 3, one as large passes") {
  ForceSettings settings;
  AssetMetadata asset;
  asset.probe_radius = 0.5e-3;
  settings.probe_radius = 0.5e-3;
  REQUIRE(check_asset(asset, settings, "a"));
  settings.probe_radius = 0.6e-3;
  const auto checked = check_asset(asset, settings, "a");
  REQUIRE_FALSE(checked);
  REQUIRE(checked.error().code == ExitCode::invalid_input);
  REQUIRE(checked.error().message.find("--probe") != std::string::npos);
}
