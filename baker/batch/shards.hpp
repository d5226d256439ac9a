// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/batch/manifest.hpp"
#include "common/base/error.hpp"

namespace spm::baker {

/// One of several parts of a manifest, counted from 1.
struct Shard {
  unsigned index = 1;
  unsigned count = 1;
};

/// Reads `I/N`. Errors: usage for anything else, and for an I that is not from 1 to N.
[[nodiscard]] Result<Shard> parse_shard(const std::string& text);

/// The shard of each of some costs, counted from 1: the dearest first, each to the shard that has
/// least so far. The same costs give the same shards.
[[nodiscard]] std::vector<unsigned> shards_of(const std::vector<double>& costs, unsigned count);

/// The assets of a shard, in the manifest's order. Every asset is in exactly one of them.
/// Scenes have no parts then, unless the shard is the whole: only the whole can finish them.
[[nodiscard]] Manifest part_of(const Manifest& manifest, const Shard& shard);

}  // namespace spm::baker
