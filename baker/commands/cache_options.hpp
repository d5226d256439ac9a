// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "baker/cache/cache.hpp"

namespace spm::baker {

/// The options of `build` and `batch` that spare bakes.
struct CacheOptions {
  std::string folder;
  RemoteOptions remote;  ///< without a URL: none
  bool explain = false;
  std::string depfile;
};

void add_cache_options(CLI::App& command, CacheOptions& options);

/// The cache that was asked for, with the token of the environment; nothing where none was. Errors:
/// those of Cache::open and of RemoteCache::open.
[[nodiscard]] Result<std::optional<Cache>> opened_cache(const CacheOptions& options);

/// "hit: the same build", from a report.
[[nodiscard]] std::string explained(const nlohmann::ordered_json& report);

}  // namespace spm::baker
