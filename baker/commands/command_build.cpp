// SPDX-License-Identifier: GPL-3.0-or-later
#include <spdlog/spdlog.h>

#include <iostream>
#include <memory>

#include "baker/batch/depfile.hpp"
#include "baker/build/build.hpp"
#include "baker/cache/cached_build.hpp"
#include "baker/commands/cache_options.hpp"
#include "baker/commands/commands.hpp"
#include "formats/cli/command_line.hpp"

namespace spm::baker {
namespace {

struct BuildSettings {
  BuildRequest request;
  CacheOptions cache;
  cli::GlobalOptions global;
};

int run(const BuildSettings& settings) {
  cli::configure_messages(settings.global);
  const Result<std::optional<Cache>> cache = opened_cache(settings.cache);
  if (!cache) return cli::report(cache.error());
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
  cli::add_global_options(*command, settings->global);
  return {command, [settings] { return run(*settings); }};
}

}  // namespace spm::baker
