// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <iostream>
#include <memory>
#include <new>

#include "baker/base/bake_error.hpp"
#include "baker/commands/build.hpp"
#include "baker/commands/commands.hpp"
#include "baker/commands/manifest.hpp"
#include "formats/cli/command_line.hpp"

namespace spm::baker {
namespace {

struct BatchSettings {
  std::string manifest;
  bool keep_going = false;
  cli::GlobalOptions global;
};

/// Bakes one entry. A failure is the result of that entry, and no reason to lose the others.
Result<BuildReport> build_entry(const BuildRequest& request, const Progress& progress) {
  try {
    return run_build(request, progress);
  } catch (const BakeError& error) {
    return fail(error.code(), error.what());
  } catch (const std::bad_alloc&) {
    return fail(ExitCode::internal, request.mesh + ": out of memory; bake with a larger tolerance");
  } catch (const std::exception& error) {
    return fail(ExitCode::internal, request.mesh + ": " + error.what());
  }
}

nlohmann::ordered_json line_of(const std::string& name, const Result<BuildReport>& report) {
  nlohmann::ordered_json line;
  line["name"] = name;
  line["ok"] = report.has_value();
  line["error"] =
      report ? nlohmann::ordered_json() : nlohmann::ordered_json(report.error().message);
  line["exit_code"] = report ? 0 : static_cast<int>(report.error().code);
  if (report) line.update(report->json);
  return line;
}

void tell(const BatchSettings& settings, const std::string& name,
          const Result<BuildReport>& report) {
  if (settings.global.json) {
    cli::print_json(line_of(name, report));
  }
  if (!report) {
    spdlog::error("{}: {}", name, report.error().message);
    return;
  }
  for (const std::string& warning : report->warnings) spdlog::warn("{}: {}", name, warning);
  if (settings.global.json || settings.global.quiet) return;
  std::cout << fmt::format("{}: {}, {} bytes, {:.1f} s\n", name,
                           report->json["output"].get<std::string>(),
                           report->json["bytes"].get<std::uint64_t>(),
                           report->json["seconds"]["total"].get<double>())
            << std::flush;
}

int run(const BatchSettings& settings) {
  cli::configure_messages(settings.global);
  const auto entries = read_manifest(settings.manifest);
  if (!entries) return cli::report(entries.error());
  bool failed = false;
  for (const ManifestEntry& entry : *entries) {
    Result<BuildReport> report;
    {
      cli::ProgressLine line(settings.global);
      report = build_entry(entry.request, [&](const char* stage, double done) {
        line.update((entry.name + ": " + stage).c_str(), done);
      });
    }
    tell(settings, entry.name, report);
    failed = failed || !report;
    if (failed && !settings.keep_going) break;
  }
  return failed ? static_cast<int>(ExitCode::batch_failed) : 0;
}

}  // namespace

Command add_batch_command(CLI::App& app) {
  auto settings = std::make_shared<BatchSettings>();
  CLI::App* command =
      app.add_subcommand("batch", "Bakes the assets of a manifest, one after another");
  command->add_option("MANIFEST", settings->manifest, "TOML file with an [[asset]] table each")
      ->required()
      ->type_name("");
  command->add_flag("--keep-going", settings->keep_going,
                    "bake the other assets after one failed (exit 11 at the end)");
  cli::add_global_options(*command, settings->global);
  return {command, [settings] { return run(*settings); }};
}

}  // namespace spm::baker
