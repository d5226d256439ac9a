// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/batch/shards.hpp"

#include <algorithm>
#include <charconv>
#include <functional>
#include <numeric>
#include <queue>
#include <utility>

#include "baker/batch/cost.hpp"

namespace spm::baker {
namespace {

constexpr unsigned most_shards = 1'000'000;

}  // namespace

Result<Shard> parse_shard(const std::string& text) {
  Shard shard;
  const char* end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  if (index.ec == std::errc() && index.ptr != end && *index.ptr == '/') {
    const auto count = std::from_chars(index.ptr + 1, end, shard.count);
    const bool whole = count.ec == std::errc() && count.ptr == end;
    if (whole && shard.count >= 1 && shard.count <= most_shards && shard.index >= 1 &&
        shard.index <= shard.count) {
      return shard;
    }
  }
  return fail(ExitCode::usage, "'" + text +
                                   "' will not do: write the shard and how many there are, from "
                                   "1/N to N/N with N up to 1000000, such as 2/8");
}

std::vector<unsigned> shards_of(const std::vector<double>& costs, unsigned count) {
  std::vector<std::size_t> order(costs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return costs[a] > costs[b]; });
  // Ties go to the shard of the smaller number.
  using Load = std::pair<double, unsigned>;
  std::priority_queue<Load, std::vector<Load>, std::greater<>> loads;
  for (unsigned shard = 1; shard <= count; ++shard) loads.emplace(0.0, shard);
  std::vector<unsigned> shards(costs.size());
  for (const std::size_t asset : order) {
    const auto [load, shard] = loads.top();
    loads.pop();
    shards[asset] = shard;
    loads.emplace(load + costs[asset], shard);
  }
  return shards;
}

Manifest part_of(const Manifest& manifest, const Shard& shard) {
  if (shard.count == 1) return manifest;
  std::vector<double> costs;
  for (const ManifestEntry& entry : manifest.entries) {
    costs.push_back(estimated_cost(entry.request));
  }
  const std::vector<unsigned> shards = shards_of(costs, shard.count);
  Manifest part = manifest;
  part.entries.clear();
  for (std::size_t i = 0; i < shards.size(); ++i) {
    if (shards[i] == shard.index) part.entries.push_back(manifest.entries[i]);
  }
  for (ManifestScene& scene : part.scenes) scene.parts.clear();  // numbers of the whole's entries
  return part;
}

}  // namespace spm::baker
