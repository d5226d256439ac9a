// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/smooth/smooth_options.hpp"

#include <nlohmann/json.hpp>
#include <numbers>

#include "common/base/units.hpp"

namespace spm::baker {
namespace {

using Json = nlohmann::ordered_json;

bool usable(const SmoothOptions& options) {
  const bool turns =
      options.kind != Smoothing::crease || (options.angle > 0 && options.angle < std::numbers::pi);
  return options.sigma > 0 && turns;
}

}  // namespace

Result<SmoothOptions> parse_smoothing(const std::string& text) {
  constexpr std::string_view gaussian = "gaussian:", crease = "crease:";
  const auto wrong = [&](const std::string& cause) {
    return fail(ExitCode::usage, "'" + text + "' " + cause);
  };
  SmoothOptions options;
  if (text == "none") return options;
  if (text.starts_with(gaussian)) {
    const Result<double> sigma =
        parse_quantity(std::string_view(text).substr(gaussian.size()), Quantity::length);
    if (!sigma) return tl::make_unexpected(sigma.error());
    if (!(*sigma > 0)) return wrong("smooths nothing: write none, or a SIGMA above 0");
    options.kind = Smoothing::gaussian;
    options.sigma = *sigma;
    return options;
  }
  if (text.starts_with(crease)) {
    const Result<double> angle =
        parse_quantity(std::string_view(text).substr(crease.size()), Quantity::angle);
    if (!angle) return tl::make_unexpected(angle.error());
    if (!(*angle > 0 && *angle < std::numbers::pi)) {
      return wrong("will not do: the ANGLE of an edge is above 0deg and below 180deg");
    }
    options.kind = Smoothing::crease;
    options.angle = *angle;
    return options;
  }
  return wrong(
      "will not do: write none, gaussian:SIGMA such as gaussian:0.5mm, or crease:ANGLE "
      "such as crease:30deg");
}

Json smoothing_json(const SmoothOptions& options) {
  if (options.kind == Smoothing::none) return nullptr;
  if (options.kind == Smoothing::gaussian) return {{"kind", "gaussian"}, {"sigma", options.sigma}};
  return {{"kind", "crease"}, {"angle", options.angle}, {"sigma", options.sigma}};
}

Result<SmoothOptions> recorded_smoothing(const std::string& options) {
  const Json json = Json::parse(options, nullptr, false);
  if (!json.is_object() || !json.contains("smooth")) return SmoothOptions{};
  const Json& smooth = json["smooth"];
  SmoothOptions read;
  const auto number = [&](const char* key) {
    return smooth.is_object() && smooth.contains(key) && smooth[key].is_number()
               ? smooth[key].get<double>()
               : 0.0;
  };
  const Json kind = smooth.is_object() ? smooth.value("kind", Json()) : Json();
  if (kind == "gaussian") read.kind = Smoothing::gaussian;
  if (kind == "crease") read.kind = Smoothing::crease;
  read.sigma = number("sigma");
  read.angle = number("angle");
  if (read.kind == Smoothing::none || !usable(read)) {
    return fail(ExitCode::invalid_input,
                "options.smooth of the asset is no smoothing that this program knows; verify it "
                "with the program that baked it");
  }
  return read;
}

}  // namespace spm::baker
