// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/commands/cache_options.hpp"

#include "formats/cli/command_line.hpp"

namespace spm::baker {

void add_cache_options(CLI::App& command, CacheOptions& options) {
  const char* group = "Bakes that are spared";
  command
      .add_option("--cache", options.folder,
                  "folder that keeps what was baked, and gives it back where mesh and options are "
                  "the same (default none)")
      ->type_name("DIR")
      ->group(group);
  command.add_flag("--explain", options.explain, "say why the cache had an asset or had it not")
      ->group(group);
  command
      .add_option("--depfile", options.depfile,
                  "file to write with what the outputs are made from, for make and ninja")
      ->type_name("FILE")
      ->group(group);
}

Result<std::optional<Cache>> opened_cache(const CacheOptions& options) {
  if (options.folder.empty()) return std::optional<Cache>();
  return Cache::open(options.folder).map([](Cache cache) {
    return std::optional<Cache>(std::move(cache));
  });
}

std::string explained(const nlohmann::ordered_json& report) {
  const std::string state = report.value("cache", "off");
  const std::string reason = report.value("cache_reason", "");
  return reason.empty() ? state : state + ": " + reason;
}

}  // namespace spm::baker
