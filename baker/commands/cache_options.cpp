// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/commands/cache_options.hpp"

#include <cstdlib>

#include "formats/cli/command_line.hpp"

namespace spm::baker {

namespace {

constexpr std::uint64_t most_timeout = 3600;  // s

}  // namespace

void add_cache_options(CLI::App& command, CacheOptions& options) {
  const char* group = "Bakes that are spared";
  CLI::Option* folder =
      command
          .add_option("--cache", options.folder,
                      "folder that keeps what was baked, and gives it back where mesh and options "
                      "are the same (default none)")
          ->type_name("DIR")
          ->group(group);
  command
      .add_option("--remote-cache", options.remote.url,
                  "address of a plain HTTP store that is asked for what the folder has not, and "
                  "gets what was baked (GET, HEAD, PUT; default none)")
      ->type_name("URL")
      ->needs(folder)
      ->group(group);
  cli::add_integer(
      command, "--remote-timeout", 1, most_timeout,
      [&options](std::uint64_t n) { options.remote.timeout_seconds = static_cast<long>(n); },
      "seconds of silence after which that store is left alone, 1 to 3600 (default 5)")
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
  Result<Cache> cache = Cache::open(options.folder);
  if (!cache) return tl::make_unexpected(cache.error());
  if (!options.remote.url.empty()) {
    RemoteOptions wanted = options.remote;
    if (const char* token = std::getenv(remote_token_variable)) wanted.token = token;
    Result<RemoteCache> remote = RemoteCache::open(std::move(wanted));
    if (!remote) return tl::make_unexpected(remote.error());
    cache->set_remote(std::move(*remote));
  }
  return std::optional<Cache>(std::move(*cache));
}

std::string explained(const nlohmann::ordered_json& report) {
  const std::string state = report.value("cache", "off");
  const std::string reason = report.value("cache_reason", "");
  return reason.empty() ? state : state + ": " + reason;
}

}  // namespace spm::baker
