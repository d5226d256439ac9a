// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <tbb/info.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>

#include "baker/base/bake_error.hpp"
#include "baker/batch/batch.hpp"
#include "baker/batch/cost.hpp"
#include "baker/batch/depfile.hpp"
#include "baker/batch/result_file.hpp"
#include "baker/batch/scenes.hpp"
#include "baker/batch/shards.hpp"
#include "baker/build/build_request.hpp"
#include "baker/cache/cached_build.hpp"
#include "baker/commands/cache_options.hpp"
#include "baker/commands/commands.hpp"
#include "baker/commands/report_command.hpp"
#include "baker/report/batch_report.hpp"
#include "formats/asset/asset_writer.hpp"
#include "formats/cli/byte_size.hpp"
#include "formats/cli/command_line.hpp"
#include "formats/files/output_file.hpp"

namespace spm::baker {
namespace {

constexpr std::uint64_t most_jobs = 1024;

struct BatchSettings {
  std::string manifest;
  BatchOptions options;
  CacheOptions cache;
  Shard shard;
  std::string result;  ///< file to write; may be empty
  std::string page;    ///< the same, for the browser
  bool dry_run = false;
  FailOn fail_on{};  ///< of every entry
  cli::GlobalOptions global;
};

void tell(const BatchSettings& settings, const std::string& name, const AssetOutcome& outcome) {
  if (settings.global.json) cli::print_json(line_of(name, outcome));
  if (!outcome.ok()) {
    spdlog::error("{}: {}", name, outcome.error);
    return;
  }
  for (const std::string& warning : outcome.warnings) spdlog::warn("{}: {}", name, warning);
  if (settings.global.json || settings.global.quiet) return;
  std::cout << fmt::format("{}: {}, {} bytes, {:.1f} s\n", name,
                           outcome.report["output"].get<std::string>(),
                           outcome.report["bytes"].get<std::uint64_t>(),
                           outcome.report["seconds"]["total"].get<double>());
  if (settings.cache.explain) {
    std::cout << fmt::format("{}: cache {}\n", name, explained(outcome.report));
  }
  std::cout << std::flush;
}

/// Says in one sentence which assets failed. Gives the exit code.
int summed_up(const Manifest& manifest, const std::vector<AssetOutcome>& outcomes) {
  constexpr std::size_t most_named = 20;
  std::size_t failed = 0, unknown = 0;
  std::string names;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    if (!outcomes[i].known) ++unknown;
    if (!outcomes[i].known || outcomes[i].ok()) continue;
    if (++failed <= most_named) {
      names += fmt::format("{}{} (exit {})", failed > 1 ? ", " : "", manifest.entries[i].name,
                           static_cast<int>(outcomes[i].code));
    }
  }
  if (failed == 0) return 0;
  if (failed > most_named) names += fmt::format(" and {} more", failed - most_named);
  spdlog::error("{} of {} assets failed{}: {}", failed, outcomes.size(),
                unknown > 0 ? fmt::format(" and {} were not begun", unknown) : std::string(),
                names);
  return static_cast<int>(ExitCode::batch_failed);
}

/// Finishes the scenes of a whole manifest, and tells of each. Gives the exit code.
int finish(const BatchSettings& settings, const Manifest& manifest,
           const std::vector<AssetOutcome>& outcomes) {
  const auto done = [&](const ManifestEntry& entry) {
    return outcomes[static_cast<std::size_t>(&entry - manifest.entries.data())].ok();
  };
  int code = 0;
  const std::vector<SceneOutcome> scenes = finish_scenes(manifest, done);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const ManifestScene& scene = manifest.scenes[i];
    if (settings.global.json) cli::print_json(line_of(scene, scenes[i]));
    if (!scenes[i].ok()) {
      spdlog::error("{}: {}", scene.name, scenes[i].error);
      code = static_cast<int>(ExitCode::batch_failed);
    } else if (!settings.global.json && !settings.global.quiet) {
      std::cout << fmt::format("{}: {}\n", scene.name,
                               scene.output.empty() ? scene.scene + ": checked" : scene.output);
    }
  }
  return code;
}

/// What the cache would do; no failure, since the bake itself will tell of it.
CacheForecast forecast_of(const std::optional<Cache>& cache, const BuildRequest& request) {
  if (!cache) return {};
  try {
    return forecast(*cache, request);
  } catch (const BakeError& problem) {
    return {false, problem.what()};
  }
}

/// Tells what would be baked, and the mistakes that show without a bake.
int rehearse(const BatchSettings& settings, const Manifest& manifest,
             const std::optional<Cache>& cache) {
  std::vector<AssetOutcome> outcomes = checked_before(manifest);
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const ManifestEntry& entry = manifest.entries[i];
    if (outcomes[i].known) {
      tell(settings, entry.name, outcomes[i]);
      continue;
    }
    outcomes[i].known = true;
    const CacheForecast found = forecast_of(cache, entry.request);
    const char* state = !cache ? "off" : found.hit ? "hit" : "miss";
    if (settings.global.json) {
      nlohmann::ordered_json line = line_of(entry.name, outcomes[i]);
      line["dry_run"] = true;
      line["mesh"] = {{"path", entry.request.mesh}};
      line["output"] = entry.request.output;
      line["estimate"] = {{"seconds", estimated_cost(entry.request)},
                          {"memory_bytes", estimated_memory(entry.request)}};
      line["cache"] = state;
      if (cache) line["cache_reason"] = found.reason;
      cli::print_json(line);
    } else if (!settings.global.quiet) {
      std::cout << fmt::format("{}: {} -> {}{}\n", entry.name, entry.request.mesh,
                               entry.request.output,
                               cache ? fmt::format(" ({}: {})", state, found.reason) : "");
    }
  }
  for (const ManifestScene& scene : manifest.scenes) {
    if (settings.global.json) {
      nlohmann::ordered_json line = line_of(scene, {});
      line["dry_run"] = true;
      cli::print_json(line);
    } else if (!settings.global.quiet) {
      std::cout << fmt::format("{}: {}{}\n", scene.name, scene.scene,
                               scene.output.empty() ? ": checked" : " -> " + scene.output);
    }
  }
  return summed_up(manifest, outcomes);
}

/// An old result must not pass for one of this run, which may be killed.
Result<void> clear_result(const std::string& path) {
  if (path.empty()) return {};
  if (Result<void> writable = check_output_path(path); !writable) return writable;
  std::error_code problem;
  std::filesystem::remove(path, problem);
  if (!problem) return {};
  return fail(ExitCode::file_or_device, path + ": the old result cannot be removed: " +
                                            problem.message() + "; write elsewhere");
}

/// The page of --report. All bakes are over: no process is forked beside the threads that draw.
Result<void> write_page(const BatchSettings& settings, const Manifest& manifest,
                        const std::vector<AssetOutcome>& outcomes) {
  std::vector<BatchLine> lines;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const ManifestEntry& entry = manifest.entries[i];
    BatchLine& line = lines.emplace_back();
    line.file = entry.request.output;
    line.line = outcomes[i].known ? line_of(entry.name, outcomes[i])
                                  : nlohmann::ordered_json{{"name", entry.name}, {"ok", nullptr}};
  }
  return write_file(settings.page, filled_page(built_page(ReportPage::batch),
                                               batch_json(settings.manifest, lines)));
}

/// What is left of a batch for other programs: its result and what its outputs are made from.
Result<void> write_notes(const BatchSettings& settings, const Manifest& manifest,
                         const std::vector<AssetOutcome>& outcomes) {
  if (!settings.cache.depfile.empty()) {
    Result<void> written = write_depfile(settings.cache.depfile, dependencies_of(manifest));
    if (!written) return written;
  }
  if (!settings.page.empty()) {
    Result<void> written = write_page(settings, manifest, outcomes);
    if (!written) return written;
  }
  if (settings.result.empty()) return {};
  return write_result(settings.result, result_of(manifest, settings.shard, outcomes));
}

int run(const BatchSettings& settings) {
  cli::configure_messages(settings.global);
  const Result<Manifest> whole = read_manifest(settings.manifest);
  if (!whole) return cli::report(whole.error());
  Manifest manifest = part_of(*whole, settings.shard);
  for (ManifestEntry& entry : manifest.entries) {
    FailOn& fail_on = entry.request.fail_on;
    std::transform(fail_on.begin(), fail_on.end(), settings.fail_on.begin(), fail_on.begin(),
                   std::logical_or<>());
  }
  Result<std::optional<Cache>> cache = opened_cache(settings.cache);
  if (!cache) return cli::report(cache.error());
  if (settings.dry_run && !settings.page.empty()) {
    return cli::report(Error{ExitCode::usage,
                             "--report: a --dry-run bakes nothing to show; leave one of them out"});
  }
  if (settings.dry_run) return rehearse(settings, manifest, *cache);
  if (!settings.page.empty()) check_report(settings.page, ReportPage::batch);
  if (const Result<void> cleared = clear_result(settings.result); !cleared) {
    return cli::report(cleared.error());
  }
  BatchOptions options = settings.options;
  options.cache = std::move(*cache);
  options.cores = static_cast<unsigned>(tbb::info::default_concurrency());
  cli::ProgressLine line(settings.global);
  BatchListener listener;
  listener.told = [&](const ManifestEntry& entry, const AssetOutcome& outcome) {
    line.clear();
    tell(settings, entry.name, outcome);
  };
  listener.progress = [&](double done, const std::string& what) {
    line.update("batch", done, what);
  };
  const std::vector<AssetOutcome> outcomes = run_batch(manifest, options, listener);
  line.clear();
  if (const Result<void> written = write_notes(settings, manifest, outcomes); !written) {
    return cli::report(written.error());
  }
  // A shard has some of the assets only: its scenes are left to merge.
  const int scenes = settings.shard.count == 1 ? finish(settings, manifest, outcomes) : 0;
  return std::max(scenes, summed_up(manifest, outcomes));
}

}  // namespace

Command add_batch_command(CLI::App& app) {
  auto settings = std::make_shared<BatchSettings>();
  CLI::App* command =
      app.add_subcommand("batch", "Bakes the assets of a manifest, several at once");
  command->add_option("MANIFEST", settings->manifest, "TOML file with an [[asset]] table each")
      ->required()
      ->type_name("");
  cli::add_integer(
      *command, "-j,--jobs", 1, most_jobs,
      [settings](std::uint64_t n) { settings->options.jobs = static_cast<unsigned>(n); },
      "assets to bake at once, 1 to 1024; they share the cores, and the output is the same for any "
      "(default 1)");
  command->add_flag("--keep-going", settings->options.keep_going,
                    "bake the other assets after one failed (exit 11 at the end)");
  command->add_flag("--dry-run", settings->dry_run,
                    "only check the manifest, its meshes and its outputs, and list them");
  cli::add_parsed(
      *command, "--shard",
      [settings](const std::string& text) -> Result<void> {
        return parse_shard(text).map([&](Shard shard) { settings->shard = shard; });
      },
      "bake only the I-th of N parts, which take about as long as each other", "I/N");
  command
      ->add_option("--result", settings->result,
                   "file to write with what became of each asset, for 'spm-bake merge'")
      ->type_name("FILE");
  command
      ->add_option("--report", settings->page,
                   "page for the browser to write with all assets, failures first, whole in one "
                   "file")
      ->type_name("PAGE.html");
  cli::add_parsed(
      *command, "--memory",
      [settings](const std::string& text) -> Result<void> {
        return cli::parse_byte_size(text).map(
            [&](std::uint64_t bytes) { settings->options.memory = bytes; });
      },
      "begin no bake beside others that might exceed so much memory with them, such as 8GB",
      "SIZE");
  add_fail_on(*command, settings->fail_on);
  add_cache_options(*command, settings->cache);
  cli::add_global_options(*command, settings->global);
  return {command, [settings] { return run(*settings); }};
}

}  // namespace spm::baker
