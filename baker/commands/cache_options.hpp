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
  bool explain = false;
  std::string depfile;
};

void add_cache_options(CLI::App& command, CacheOptions& options);

/// The cache that was asked for; nothing where none was. Errors: those of Cache::open.
[[nodiscard]] Result<std::optional<Cache>> opened_cache(const CacheOptions& options);

/// "hit: the same build", from a report.
[[nodiscard]] std::string explained(const nlohmann::ordered_json& report);

}  // namespace spm::baker
