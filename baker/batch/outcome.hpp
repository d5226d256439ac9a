// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "baker/base/progress.hpp"
#include "baker/batch/workers.hpp"
#include "baker/cache/cached_build.hpp"

namespace spm::baker {

/// What became of one asset of a batch.
// NOLINTNEXTLINE(bugprone-exception-escape): a JSON value allocates while it is destroyed.
struct AssetOutcome {
  bool known = false;  ///< false for what was never begun
  ExitCode code = ExitCode::done;
  std::string error;
  nlohmann::ordered_json report;  ///< of build, where it was done
  std::vector<std::string> warnings;

  [[nodiscard]] bool ok() const { return known && code == ExitCode::done; }
};

[[nodiscard]] AssetOutcome failed_outcome(Error error);

/// Builds, through a cache where there is one; whatever goes wrong is the outcome of that asset,
/// and no reason to lose the others.
[[nodiscard]] AssetOutcome built_outcome(const Cache* cache, const BuildRequest& request,
                                         const Progress& progress);

/// An outcome as one line, for the way between processes.
[[nodiscard]] std::string encoded(const AssetOutcome& outcome);

/// The outcome that a job ended with. One that has no answer was ended by a signal, or by its time
/// limit: then what it wrote to stderr says so.
[[nodiscard]] AssetOutcome outcome_of(const JobEvent& end, const BuildRequest& request);

/// The asset's line of `batch --json`.
[[nodiscard]] nlohmann::ordered_json line_of(const std::string& name, const AssetOutcome& outcome);

}  // namespace spm::baker
