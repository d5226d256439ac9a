// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "baker/batch/manifest.hpp"
#include "baker/batch/outcome.hpp"

namespace spm::baker {

struct BatchOptions {
  unsigned jobs = 1;   ///< bakes at once
  unsigned cores = 1;  ///< shared out among them
  bool keep_going = false;
  std::optional<Cache> cache;
  std::optional<std::uint64_t> memory;  ///< bytes that bakes at once may take, by estimate
};

/// Who hears of a batch while it runs.
struct BatchListener {
  /// The outcome of an asset; in the manifest's order, whichever ends first.
  std::function<void(const ManifestEntry&, const AssetOutcome&)> told;
  /// The part of all the work that is done, 0 to 1, and what is at work.
  std::function<void(double done, const std::string& what)> progress;
};

/// Mistakes that show before the first bake: meshes that cannot be read and outputs that cannot be
/// written. One outcome an entry; unknown where there is no mistake.
[[nodiscard]] std::vector<AssetOutcome> checked_before(const Manifest& manifest);

/// Bakes the entries of a manifest, `jobs` at once, each in a process of its own. Without
/// `keep_going` nothing is begun after a failure, and nothing at all where a mistake shows before.
/// Gives one outcome an entry.
[[nodiscard]] std::vector<AssetOutcome> run_batch(const Manifest& manifest,
                                                  const BatchOptions& options,
                                                  const BatchListener& listener);

/// The threads of a bake that begins, so that all that may run at once get about the same: `free`
/// cores are left for `beginning` bakes.
[[nodiscard]] unsigned thread_share(unsigned free, unsigned beginning);

}  // namespace spm::baker
