// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "baker/cache/cache.hpp"

namespace spm::baker {

struct CacheStats {
  std::uint64_t entries = 0;
  std::uint64_t bytes = 0;      ///< of the entries
  std::uint64_t outputs = 0;    ///< whose last key is known
  std::uint64_t leftovers = 0;  ///< files of writers that were killed
};

[[nodiscard]] CacheStats stats_of(const Cache& cache);

struct CachePruning {
  std::uint64_t removed = 0, removed_bytes = 0;
  std::uint64_t left = 0, left_bytes = 0;
};

/// Removes entries until the rest takes no more than so many bytes, those first that were not used
/// for the longest time; and what killed writers left more than an hour ago.
[[nodiscard]] CachePruning prune(const Cache& cache, std::uint64_t max_bytes);

/// Checks every entry. Gives one sentence for each that is not whole.
struct CacheVerdict {
  std::uint64_t entries = 0;
  std::vector<std::string> problems;
};
[[nodiscard]] CacheVerdict verify_cache(const Cache& cache);

}  // namespace spm::baker
