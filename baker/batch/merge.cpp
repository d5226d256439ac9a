// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/batch/merge.hpp"

#include <fmt/format.h>

#include <map>
#include <unordered_map>
#include <unordered_set>

#include "formats/files/sha256.hpp"

namespace spm::baker {
namespace {

using Results = std::vector<std::pair<std::string, BatchResult>>;

tl::unexpected<Error> refuse(const std::string& path, const std::string& cause) {
  return fail(ExitCode::invalid_input, path + ": " + cause);
}

/// The file of each shard; refuses those that do not belong together.
Result<std::map<unsigned, std::string>> shards_in(const Manifest& manifest,
                                                  const Results& results) {
  std::map<unsigned, std::string> files;
  const unsigned count = results.front().second.shard.count;
  for (const auto& [path, result] : results) {
    const Shard& shard = result.shard;
    if (result.manifest_sha256 != manifest.sha256) {
      return refuse(path, fmt::format("is of another manifest than {}, or of what that was before; "
                                      "run the shard again",
                                      manifest.path));
    }
    if (shard.count != count || shard.index < 1 || shard.index > count) {
      return refuse(path, fmt::format("is of shard {}/{}, but {} is of {} shards; give the results "
                                      "of one run",
                                      shard.index, shard.count, results.front().first, count));
    }
    const auto [other, first] = files.emplace(shard.index, path);
    if (!first) {
      return refuse(path, fmt::format("is of shard {}/{}, and so is {}; give each shard once",
                                      shard.index, shard.count, other->second));
    }
  }
  return files;
}

void judge(const ManifestEntry& entry, const AssetResult* result, Merged& merged) {
  if (result == nullptr || !result->begun) {
    merged.missing.push_back(entry.name);
  } else if (result->code != ExitCode::done) {
    merged.failed.emplace_back(entry.name, result->error);
  } else {
    const Result<std::string> hash = sha256_file(entry.request.output);
    const bool there = hash && *hash == result->sha256;
    (there ? merged.done : merged.lost).push_back(entry.name);
  }
}

}  // namespace

Result<Merged> merge_results(const Manifest& manifest, const Results& results) {
  Merged merged;
  if (results.empty()) return fail(ExitCode::usage, "no result is given; name files of --result");
  const auto files = shards_in(manifest, results);
  if (!files) return tl::make_unexpected(files.error());
  merged.shards = results.front().second.shard.count;
  for (unsigned index = 1; index <= merged.shards; ++index) {
    if (files->count(index) == 0) merged.missing_shards.push_back(index);
  }
  std::unordered_set<std::string> wanted;
  for (const ManifestEntry& entry : manifest.entries) wanted.insert(entry.output);
  std::unordered_map<std::string, const AssetResult*> found;
  for (const auto& [path, result] : results) {
    for (const AssetResult& asset : result.assets) {
      if (wanted.count(asset.output) == 0) {
        return refuse(path, fmt::format("has the asset {}, which {} has not: were meshes added or "
                                        "removed since? run all shards again",
                                        asset.output, manifest.path));
      }
      if (!found.emplace(asset.output, &asset).second) {
        return refuse(path, fmt::format("has the asset {}, and so has another shard: did meshes "
                                        "change while the shards ran? run all of them again",
                                        asset.output));
      }
    }
  }
  for (const ManifestEntry& entry : manifest.entries) {
    const auto result = found.find(entry.output);
    judge(entry, result == found.end() ? nullptr : result->second, merged);
  }
  return merged;
}

}  // namespace spm::baker
