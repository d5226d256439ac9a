// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <iostream>
#include <memory>

#include "baker/cache/upkeep.hpp"
#include "baker/commands/commands.hpp"
#include "formats/cli/byte_size.hpp"
#include "formats/cli/command_line.hpp"

namespace spm::baker {
namespace {

enum class Action { stats, prune, verify };

struct CacheSettings {
  Action action = Action::stats;
  std::string folder;
  std::optional<std::uint64_t> max_size;
  cli::GlobalOptions global;
};

void tell(const CacheSettings& settings, const nlohmann::ordered_json& json,
          const std::string& text) {
  if (settings.global.json) {
    cli::print_json(json);
  } else if (!settings.global.quiet) {
    std::cout << text << '\n';
  }
}

int tell_stats(const CacheSettings& settings, const Cache& cache) {
  const CacheStats stats = stats_of(cache);
  tell(settings,
       {{"entries", stats.entries},
        {"bytes", stats.bytes},
        {"outputs", stats.outputs},
        {"leftovers", stats.leftovers}},
       fmt::format("{}: {} entries, {} bytes; {} outputs known, {} leftovers of killed writers",
                   settings.folder, stats.entries, stats.bytes, stats.outputs, stats.leftovers));
  return 0;
}

int run_prune(const CacheSettings& settings, const Cache& cache) {
  if (!settings.max_size) {
    return cli::report({ExitCode::usage,
                        "--max-size is missing: prune needs the size that is left at most, such "
                        "as --max-size 10GB"});
  }
  const CachePruning pruning = prune(cache, *settings.max_size);
  tell(settings,
       {{"removed", pruning.removed},
        {"removed_bytes", pruning.removed_bytes},
        {"entries", pruning.left},
        {"bytes", pruning.left_bytes}},
       fmt::format("{}: {} entries removed, {} bytes; {} left, {} bytes", settings.folder,
                   pruning.removed, pruning.removed_bytes, pruning.left, pruning.left_bytes));
  return 0;
}

int run_verify(const CacheSettings& settings, const Cache& cache) {
  const CacheVerdict verdict = verify_cache(cache);
  for (const std::string& problem : verdict.problems) spdlog::error("{}", problem);
  tell(
      settings,
      {{"entries", verdict.entries},
       {"corrupt", verdict.problems.size()},
       {"problems", verdict.problems},
       {"passed", verdict.problems.empty()}},
      fmt::format("{}: {} entries, {} of them corrupt{}", settings.folder, verdict.entries,
                  verdict.problems.size(),
                  verdict.problems.empty() ? "" : "; the next build that needs one bakes it anew"));
  return verdict.problems.empty() ? 0 : static_cast<int>(ExitCode::invalid_input);
}

int run(const CacheSettings& settings) {
  cli::configure_messages(settings.global);
  const Result<Cache> cache = Cache::open(settings.folder, false);
  if (!cache) return cli::report(cache.error());
  switch (settings.action) {
    case Action::stats:
      return tell_stats(settings, *cache);
    case Action::prune:
      return run_prune(settings, *cache);
    case Action::verify:
      return run_verify(settings, *cache);
  }
  return static_cast<int>(ExitCode::internal);
}

}  // namespace

Command add_cache_command(CLI::App& app) {
  auto settings = std::make_shared<CacheSettings>();
  CLI::App* command =
      app.add_subcommand("cache", "Looks after a cache of baked assets: stats, prune or verify");
  cli::add_choice<Action>(
      *command, "ACTION", settings->action,
      {{"stats", Action::stats}, {"prune", Action::prune}, {"verify", Action::verify}},
      "stats: what is in it; prune: remove what was not used for longest; verify: check every "
      "entry")
      ->required();
  command->add_option("DIR", settings->folder, "folder of the cache")->required()->type_name("");
  cli::add_parsed(
      *command, "--max-size",
      [settings](const std::string& text) -> Result<void> {
        return cli::parse_byte_size(text).map(
            [&](std::uint64_t bytes) { settings->max_size = bytes; });
      },
      "prune until no more than so much is left, such as 500MB or 10GB", "SIZE");
  cli::add_global_options(*command, settings->global);
  return {command, [settings] { return run(*settings); }};
}

}  // namespace spm::baker
