// SPDX-License-Identifier: GPL-3.0-or-later
#include <spdlog/spdlog.h>

#include <iostream>
#include <memory>

#include "baker/build/build.hpp"
#include "baker/commands/commands.hpp"
#include "formats/cli/command_line.hpp"

namespace spm::baker {
namespace {

struct BuildSettings {
  BuildRequest request;
  cli::GlobalOptions global;
};

int run(const BuildSettings& settings) {
  cli::configure_messages(settings.global);
  BuildReport report;
  {
    cli::ProgressLine line(settings.global);
    report = run_build(settings.request,
                       [&line](const char* stage, double done) { line.update(stage, done); });
  }
  for (const std::string& warning : report.warnings) spdlog::warn("{}", warning);
  if (settings.global.json) {
    cli::print_json(report.json);
  } else if (!settings.global.quiet) {
    std::cout << describe(report);
  }
  return 0;
}

}  // namespace

Command add_build_command(CLI::App& app) {
  auto settings = std::make_shared<BuildSettings>();
  CLI::App* command = app.add_subcommand("build", "Bakes a mesh into an asset, FILE.spm.exr");
  add_build_options(*command, settings->request);
  cli::add_global_options(*command, settings->global);
  return {command, [settings] { return run(*settings); }};
}

}  // namespace spm::baker
