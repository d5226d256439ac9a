// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/bench/reports/bytes.hpp"

namespace spm::bench {

// Output that the reports of several modes share.

/// `mesh`, its size and tolerance, and facts about its places.
[[nodiscard]] nlohmann::ordered_json model_json(const ModelRow& model);

/// `mesh`, `method`, `settings`, `setting_um`, `bytes` (those of memory), `file_bytes`,
/// `resident_bytes`, `build_seconds`, `open_seconds`.
[[nodiscard]] nlohmann::ordered_json facts_json(const std::string& model, const MethodFacts& facts);

/// Adds the errors of distance and direction, and the shares.
void add_score(const Score& score, nlohmann::ordered_json& row);

[[nodiscard]] nlohmann::ordered_json failures_json(const std::vector<FailureRow>& failures);

/// One warning per failure.
void warn_of(const std::vector<FailureRow>& failures);

/// Such as "201 kB" or "16.1 MB".
[[nodiscard]] std::string byte_text(double bytes);

}  // namespace spm::bench
