// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "baker/base/bake_error.hpp"
#include "baker/commands/commands.hpp"
#include "baker/verify/verify.hpp"
#include "baker/verify/verify_pictures.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "formats/cli/command_line.hpp"

namespace spm::baker {
namespace {

using Json = nlohmann::ordered_json;

struct Settings {
  std::string asset;
  std::string mesh;
  std::string pictures;  ///< folder; empty: none
  VerifyOptions options;
  cli::GlobalOptions global;
};

constexpr double degrees = 180 / std::numbers::pi;

Json to_json(const ErrorSummary& error) {
  return {{"rms", error.rms * 1e6},
          {"p50", error.p50 * 1e6},
          {"p99", error.p99 * 1e6},
          {"p999", error.p999 * 1e6},
          {"max", error.max * 1e6}};
}

Json to_json(const VerifyReport& report) {
  Json json;
  json["distance_error_um"] = to_json(report.distance);
  if (report.smoothing) json["smoothing_error_um"] = to_json(*report.smoothing);
  if (report.total) json["total_error_um"] = to_json(*report.total);
  json["direction_error_deg"] = {{"p50", report.direction_p50 * degrees},
                                 {"p99", report.direction_p99 * degrees},
                                 {"max", report.direction_max * degrees}};
  json["direction_contested"] = report.direction_contested;
  json["misclassified"] = {{"inside_as_outside", report.inside_as_outside},
                           {"outside_as_inside", report.outside_as_inside}};
  json["unanswered"] = report.unanswered;
  json["pruned"] = report.pruned;
  json["near_holes"] = report.near_holes;
  json["fallback_answers"] = report.fallback_answers;
  json["samples"] = report.samples;
  const AdversarialReport& hard = report.adversarial;
  json["adversarial"] = {
      {"samples", hard.samples},
      {"distance_error_um", to_json(hard.distance)},
      {"misclassified",
       {{"inside_as_outside", hard.inside_as_outside},
        {"outside_as_inside", hard.outside_as_inside}}},
      {"unanswered", hard.unanswered},
      {"worst_point_m", {hard.worst_point.x(), hard.worst_point.y(), hard.worst_point.z()}}};
  json["band_m"] = report.band.max_depth;
  json["margin_m"] = report.band.margin;
  json["worst_point_m"] = {report.worst_point.x(), report.worst_point.y(), report.worst_point.z()};
  return json;
}

std::string line_of(const char* what, const ErrorSummary& error) {
  return fmt::format("{:<14} rms {:.3g} um, p50 {:.3g}, p99 {:.3g}, p99.9 {:.3g}, max {:.3g}\n",
                     what, error.rms * 1e6, error.p50 * 1e6, error.p99 * 1e6, error.p999 * 1e6,
                     error.max * 1e6);
}

std::string describe(const VerifyReport& report) {
  std::string text =
      fmt::format("samples        {}, from {} inside to {} outside\n", report.samples,
                  format_quantity(report.band.max_depth, Quantity::length),
                  format_quantity(report.band.margin, Quantity::length));
  text += line_of("distance error", report.distance);
  if (report.smoothing && report.total) {
    text += line_of("of smoothing", *report.smoothing);
    text += line_of("both together", *report.total);
  }
  text += fmt::format(
      "direction      p50 {:.3g} deg, p99 {:.3g}, max {:.3g} ({:.1f} % of the places are a toss-up "
      "between directions and left out)\n",
      report.direction_p50 * degrees, report.direction_p99 * degrees,
      report.direction_max * degrees, 100 * report.direction_contested);
  text +=
      fmt::format("wrong side     {:.4g} % inside taken for outside, {:.4g} % outside for inside\n",
                  100 * report.inside_as_outside, 100 * report.outside_as_inside);
  text += fmt::format("unanswered     {:.4g} %\n", 100 * report.unanswered);
  text += line_of("at hard places", report.adversarial.distance);
  if (report.pruned > 0) {
    text += fmt::format("cut away       {:.1f} % of the places, which the bake was to leave out\n",
                        100 * report.pruned);
  }
  if (report.near_holes > 0) {
    text += fmt::format(
        "near holes     {:.1f} % of the places drawn, left out: beside a hole there is "
        "no side to be right about\n",
        100 * report.near_holes);
  }
  return text;
}

int run(const Settings& settings) {
  cli::configure_messages(settings.global);
  const auto asset = MappedAsset::open(settings.asset);
  if (!asset) return cli::report(asset.error());
  const VerifyReport report =
      verify_asset((*asset)->view(), (*asset)->metadata(), settings.mesh, settings.options);
  std::vector<std::string> pictures;
  if (!settings.pictures.empty()) {
    pictures = write_error_pictures((*asset)->view(), (*asset)->metadata(), settings.mesh, report,
                                    settings.pictures);
  }
  if (settings.global.json) {
    Json json = to_json(report);
    if (!pictures.empty()) json["pictures"] = pictures;
    cli::print_json(json);
  } else if (!settings.global.quiet) {
    std::cout << describe(report);
    for (const std::string& picture : pictures) std::cout << "picture        " << picture << "\n";
  }
  return 0;
}

void check(const VerifyOptions& options) {
  if (options.band && *options.band <= 0) throw CLI::ValidationError("--band", "must be above 0");
}

}  // namespace

Command add_verify_command(CLI::App& app) {
  auto settings = std::make_shared<Settings>();
  VerifyOptions& options = settings->options;
  CLI::App* command =
      app.add_subcommand("verify", "Measures an asset's answers against the exact mesh");
  command->add_option("FILE", settings->asset, "baked file")->required()->type_name("");
  command->add_option("MESH", settings->mesh, "mesh that it was baked from")
      ->required()
      ->type_name("");
  cli::add_integer(
      *command, "--samples", 1, 100000000, [&options](std::uint64_t n) { options.samples = n; },
      "places to measure at, 1 to 100000000 (default 1000000)");
  cli::add_integer(
      *command, "--seed", 0, std::numeric_limits<std::uint64_t>::max(),
      [&options](std::uint64_t n) { options.seed = n; }, "seed of the places (default 1)");
  cli::add_quantity(*command, "--band", options.band, Quantity::length,
                    "how deep inside to measure, above 0 and at most the asset's max-depth "
                    "(default that)");
  cli::add_integer(
      *command, "--threads", 1, 1024,
      [&options](std::uint64_t n) { options.threads = static_cast<unsigned>(n); },
      "threads, 1 to 1024; the result is the same for any (default: all cores)");
  command
      ->add_option("--png", settings->pictures,
                   "write the surface and where it errs as pictures into this folder")
      ->type_name("DIR");
  cli::add_global_options(*command, settings->global);
  command->callback([settings] { check(settings->options); });
  return {command, [settings] { return run(*settings); }};
}

}  // namespace spm::baker
