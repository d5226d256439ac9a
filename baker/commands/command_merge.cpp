// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <iostream>
#include <memory>
#include <set>

#include "baker/batch/merge.hpp"
#include "baker/batch/scenes.hpp"
#include "baker/commands/commands.hpp"
#include "formats/cli/command_line.hpp"

namespace spm::baker {
namespace {

struct MergeSettings {
  std::string manifest;
  std::vector<std::string> results;
  cli::GlobalOptions global;
};

nlohmann::ordered_json json_of(const Manifest& manifest, const Merged& merged) {
  nlohmann::ordered_json json;
  json["assets"] = manifest.entries.size();
  json["done"] = merged.done.size();
  json["shards"] = merged.shards;
  json["missing_shards"] = merged.missing_shards;
  json["failed"] = nlohmann::ordered_json::array();
  for (const auto& [name, error] : merged.failed) {
    json["failed"].push_back({{"name", name}, {"error", error}});
  }
  json["missing"] = merged.missing;
  json["lost"] = merged.lost;
  return json;
}

void complain(const Merged& merged) {
  for (const unsigned shard : merged.missing_shards) {
    spdlog::error("shard {}/{}: no result is given; run it, or name its file", shard,
                  merged.shards);
  }
  for (const auto& [name, error] : merged.failed) spdlog::error("{}: {}", name, error);
  for (const std::string& name : merged.missing) {
    spdlog::error("{}: missing: no shard that is given has baked it; run its shard again", name);
  }
  for (const std::string& name : merged.lost) {
    spdlog::error(
        "{}: its output is not what its shard baked; copy it here, or run the shard again", name);
  }
}

int run(const MergeSettings& settings) {
  cli::configure_messages(settings.global);
  const Result<Manifest> manifest = read_manifest(settings.manifest);
  if (!manifest) return cli::report(manifest.error());
  std::vector<std::pair<std::string, BatchResult>> results;
  for (const std::string& path : settings.results) {
    Result<BatchResult> result = read_result(path);
    if (!result) return cli::report(result.error());
    results.emplace_back(path, std::move(*result));
  }
  const Result<Merged> merged = merge_results(*manifest, results);
  if (!merged) return cli::report(merged.error());
  complain(*merged);
  const std::set<std::string> done(merged->done.begin(), merged->done.end());
  const std::vector<SceneOutcome> scenes = finish_scenes(
      *manifest, [&](const ManifestEntry& entry) { return done.count(entry.name) > 0; });
  bool finished = true;
  for (const SceneOutcome& scene : scenes) {
    if (!scene.ok()) spdlog::error("{}", scene.error);
    finished = finished && scene.ok();
  }
  if (settings.global.json) {
    nlohmann::ordered_json json = json_of(*manifest, *merged);
    json["scenes"] = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      json["scenes"].push_back(line_of(manifest->scenes[i], scenes[i]));
    }
    json["passed"] = merged->complete() && finished;
    cli::print_json(json);
  } else if (!settings.global.quiet) {
    std::cout << fmt::format("{} of {} assets done, of {} shards\n", merged->done.size(),
                             manifest->entries.size(), merged->shards);
  }
  return merged->complete() && finished ? 0 : static_cast<int>(ExitCode::batch_failed);
}

}  // namespace

Command add_merge_command(CLI::App& app) {
  auto settings = std::make_shared<MergeSettings>();
  CLI::App* command =
      app.add_subcommand("merge", "Checks that the shards of a batch have baked every asset");
  command->add_option("MANIFEST", settings->manifest, "the manifest of the batch")
      ->required()
      ->type_name("");
  command->add_option("RESULT", settings->results, "what each shard wrote with --result")
      ->required()
      ->type_name("");
  cli::add_global_options(*command, settings->global);
  return {command, [settings] { return run(*settings); }};
}

}  // namespace spm::baker
