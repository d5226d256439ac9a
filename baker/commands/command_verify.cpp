// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "baker/base/bake_error.hpp"
#include "baker/commands/commands.hpp"
#include "baker/commands/report_command.hpp"
#include "baker/commands/verify_text.hpp"
#include "baker/verify/verify.hpp"
#include "baker/verify/verify_pictures.hpp"
#include "formats/asset/asset_writer.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "formats/cli/command_line.hpp"
#include "formats/files/output_file.hpp"

namespace spm::baker {
namespace {

using Json = nlohmann::ordered_json;

struct VerifySettings {
  std::string asset;
  std::string mesh;
  std::string pictures;   ///< folder; empty: none
  std::string worst_ply;  ///< file of the worst places; empty: none
  std::string page;       ///< file of a page that shows all; empty: none
  VerifyOptions options;
  cli::GlobalOptions global;
};

constexpr std::uint64_t max_worst = 10000;

/// The exit code of a verdict. With --quiet the verdict would not be said at all, so an error says
/// it.
int exit_code(const VerifySettings& settings, const VerifyReport& report) {
  if (report.passed()) return static_cast<int>(ExitCode::done);
  if (settings.global.quiet && !settings.global.json) {
    return cli::report(
        {ExitCode::tolerance_not_met, settings.asset + ": the promise is " + verdict_of(report)});
  }
  return static_cast<int>(ExitCode::tolerance_not_met);
}

int run(const VerifySettings& settings) {
  cli::configure_messages(settings.global);
  if (!settings.worst_ply.empty()) {
    if (const auto writable = check_output_path(settings.worst_ply); !writable) {
      return cli::report(writable.error());
    }
  }
  if (!settings.page.empty()) check_report(settings.page);
  const auto asset = MappedAsset::open(settings.asset);
  if (!asset) return cli::report(asset.error());
  const VerifyReport report =
      verify_asset((*asset)->view(), (*asset)->metadata(), settings.mesh, settings.options);
  std::vector<std::string> pictures;
  if (!settings.pictures.empty()) {
    pictures = write_error_pictures((*asset)->view(), (*asset)->metadata(), settings.mesh, report,
                                    settings.pictures);
  }
  if (!settings.worst_ply.empty()) {
    if (const auto written = write_file(settings.worst_ply, to_ply(report.worst)); !written) {
      return cli::report(written.error());
    }
  }
  if (!settings.page.empty()) {
    write_report(settings.page, **asset, settings.mesh, report, nullptr);
  }
  if (settings.global.json) {
    Json json = to_json(report);
    if (!settings.page.empty()) json["report"] = settings.page;
    if (!pictures.empty()) json["pictures"] = pictures;
    if (!settings.worst_ply.empty()) json["worst_ply"] = settings.worst_ply;
    cli::print_json(json);
  } else if (!settings.global.quiet) {
    for (const std::string& picture : pictures) std::cout << "picture        " << picture << "\n";
    if (!settings.page.empty()) std::cout << "report         " << settings.page << "\n";
    if (!settings.worst_ply.empty()) std::cout << "worst places   " << settings.worst_ply << "\n";
    std::cout << describe(report);
  }
  return exit_code(settings, report);
}

void check(const VerifyOptions& options) {
  if (options.band && *options.band <= 0) throw CLI::ValidationError("--band", "must be above 0");
}

}  // namespace

Command add_verify_command(CLI::App& app) {
  auto settings = std::make_shared<VerifySettings>();
  VerifyOptions& options = settings->options;
  CLI::App* command = app.add_subcommand(
      "verify",
      "Judges an asset's answers against the exact mesh; exit code 10 where its promise is missed");
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
                   "write the surface, what answers where, and the errors as pictures into this "
                   "folder")
      ->type_name("DIR");
  cli::add_integer(
      *command, "--worst", 0, max_worst, [&options](std::uint64_t n) { options.worst = n; },
      fmt::format("worst places to list, 0 to {} (default 20)", max_worst));
  command
      ->add_option("--worst-ply", settings->worst_ply,
                   "write these places as coloured points into this file")
      ->type_name("POINTS.ply");
  command
      ->add_option("--report", settings->page,
                   "write a page for the browser that shows all of this, whole in one file")
      ->type_name("PAGE.html");
  cli::add_global_options(*command, settings->global);
  command->callback([settings] { check(settings->options); });
  return {command, [settings] { return run(*settings); }};
}

}  // namespace spm::baker
