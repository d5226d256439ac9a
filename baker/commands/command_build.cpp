// SPDX-License-Identifier: GPL-3.0-or-later
#include <spdlog/spdlog.h>

#include <iostream>
#include <memory>

#include "baker/batch/depfile.hpp"
#include "baker/build/build.hpp"
#include "baker/cache/cached_build.hpp"
#include "baker/commands/cache_options.hpp"
#include "baker/commands/commands.hpp"
#include "baker/commands/report_command.hpp"
#include "baker/verify/verify.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "formats/cli/command_line.hpp"

namespace spm::baker {
namespace {

struct BuildSettings {
  BuildRequest request;
  CacheOptions cache;
  std::string page;  ///< file of a page that shows what came of it; empty: none
  cli::GlobalOptions global;
};

/// The page of --report: the written file is judged anew, at as many places as `verify` takes.
Result<void> show(const BuildSettings& settings, const BuildReport& report) {
  const auto asset = MappedAsset::open(settings.request.output);
  if (!asset) return tl::make_unexpected(asset.error());
  VerifyOptions options;
  options.threads = settings.request.bake.threads;
  const VerifyReport found =
      verify_asset((*asset)->view(), (*asset)->metadata(), settings.request.mesh, options);
  write_report(settings.page, **asset, settings.request.mesh, found, report.json);
  return {};
}

int run(const BuildSettings& settings) {
  cli::configure_messages(settings.global);
  const Result<std::optional<Cache>> cache = opened_cache(settings.cache);
  if (!cache) return cli::report(cache.error());
  if (!settings.page.empty()) check_report(settings.page);
  BuildReport report;
  {
    cli::ProgressLine line(settings.global);
    report = build_through(*cache ? &**cache : nullptr, settings.request,
                           [&line](const char* stage, double done) { line.update(stage, done); });
  }
  if (!settings.cache.depfile.empty()) {
    const Result<void> written =
        write_depfile(settings.cache.depfile, {dependencies_of(settings.request)});
    if (!written) return cli::report(written.error());
  }
  if (!settings.page.empty()) {
    const Result<void> shown = show(settings, report);
    if (!shown) return cli::report(shown.error());
  }
  for (const std::string& warning : report.warnings) spdlog::warn("{}", warning);
  if (settings.global.json) {
    cli::print_json(report.json);
  } else if (!settings.global.quiet) {
    std::cout << describe(report);
    if (settings.cache.explain) std::cout << "cache    " << explained(report.json) << '\n';
  }
  return 0;
}

}  // namespace

Command add_build_command(CLI::App& app) {
  auto settings = std::make_shared<BuildSettings>();
  CLI::App* command = app.add_subcommand("build", "Bakes a mesh into an asset, FILE.spm.exr");
  add_build_options(*command, settings->request);
  add_cache_options(*command, settings->cache);
  command
      ->add_option(
          "--report", settings->page,
          "write a page for the browser that judges and shows the asset, whole in one file")
      ->type_name("PAGE.html");
  cli::add_global_options(*command, settings->global);
  return {command, [settings] { return run(*settings); }};
}

}  // namespace spm::baker
