// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "baker/batch/manifest.hpp"
#include "baker/batch/result_file.hpp"

namespace spm::baker {

/// What all shards together have.
struct Merged {
  unsigned shards = 0;
  std::vector<unsigned> missing_shards;
  std::vector<std::string> done;                            ///< names of assets
  std::vector<std::pair<std::string, std::string>> failed;  ///< name and error
  std::vector<std::string> missing;                         ///< in no result, or never begun
  std::vector<std::string> lost;  ///< whose output is gone or is not what was baked

  [[nodiscard]] bool complete() const {
    return missing_shards.empty() && failed.empty() && missing.empty() && lost.empty();
  }
};

/// Collects the results of shards and holds every output against them. Each result has the path
/// that it was read from. Errors: invalid_input for results of another manifest, of another number
/// of shards, of a shard or an asset that is there twice, and of assets that the manifest has not.
[[nodiscard]] Result<Merged> merge_results(
    const Manifest& manifest, const std::vector<std::pair<std::string, BatchResult>>& results);

}  // namespace spm::baker
