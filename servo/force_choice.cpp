// SPDX-License-Identifier: Apache-2.0
#include "servo/force_choice.hpp"

#include <cmath>

#include "common/units.hpp"

namespace spm::servo {

namespace {

/// Stiffest that any device is rated for is 8 N/mm; a hundred times that is a slip of the unit.
constexpr double stiffest = 1e6;  // N/m

/// A radius that went through a decimal text may differ by rounding from the recorded one.
constexpr double radius_slack = 1e-9;

std::string radius_text(double radius) {
  return radius == 0 ? "point" : "sphere:" + format_quantity(radius, Quantity::length);
}

}  // namespace

const char* to_string(Method method) noexcept {
  switch (method) {
    case Method::spm:
      return "spm";
    case Method::paper:
      return "paper";
    case Method::proxy:
      return "proxy";
  }
  return "";
}

const char* to_string(PaperRule rule) noexcept {
  switch (rule) {
    case PaperRule::closest_plane:
      return "closest-plane";
    case PaperRule::closest_surface:
      return "closest-surface";
    case PaperRule::all_planes:
      return "all-planes";
  }
  return "";
}

const char* to_string(AssetForm form) noexcept {
  return form == AssetForm::full ? "full" : "sparse";
}

Result<void> check_settings(const ForceSettings& settings) {
  if (settings.method == Method::paper && settings.probe_radius > 0) {
    return fail(ExitCode::usage,
                "--method paper knows a point probe only; leave out --probe or take --method spm");
  }
  if (!(settings.stiffness >= 0 && settings.stiffness <= stiffest)) {
    return fail(ExitCode::usage, "--stiffness is out of range; it must be from 0N/mm to " +
                                     format_quantity(stiffest, Quantity::stiffness));
  }
  return {};
}

Result<void> check_asset(const AssetMetadata& asset, const ForceSettings& settings,
                         const std::string& path) {
  if (settings.method == Method::paper && asset.form != AssetForm::full) {
    return fail(ExitCode::invalid_input,
                path +
                    ": is a sparse asset, which --method paper cannot read; bake the mesh again "
                    "with --form full, or take --method spm");
  }
  if (settings.probe_radius > asset.probe_radius * (1 + radius_slack)) {
    return fail(ExitCode::invalid_input,
                path + ": was baked for probe " + radius_text(asset.probe_radius) +
                    ", which is smaller than " + radius_text(settings.probe_radius) +
                    "; bake the mesh again with --probe and the larger radius");
  }
  return {};
}

}  // namespace spm::servo
