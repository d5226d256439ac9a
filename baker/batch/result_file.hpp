// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "baker/batch/manifest.hpp"
#include "baker/batch/outcome.hpp"
#include "baker/batch/shards.hpp"

namespace spm::baker {

/// What became of an asset, as a file tells it to whoever collects the shards.
struct AssetResult {
  std::string name;
  std::string output;  ///< as the manifest means it
  bool begun = false;
  ExitCode code = ExitCode::done;
  std::string error;
  std::string sha256;  ///< of the baked file
};

/// The results of a shard.
struct BatchResult {
  std::string manifest_sha256;
  Shard shard;
  std::vector<AssetResult> assets;
};

[[nodiscard]] BatchResult result_of(const Manifest& part, const Shard& shard,
                                    const std::vector<AssetOutcome>& outcomes);

/// Errors: file_or_device.
[[nodiscard]] Result<void> write_result(const std::string& path, const BatchResult& result);

/// Errors: file_or_device; invalid_input for what is no such file.
[[nodiscard]] Result<BatchResult> read_result(const std::string& path);

}  // namespace spm::baker
