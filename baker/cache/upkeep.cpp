// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/cache/upkeep.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <system_error>

#include "formats/files/sha256.hpp"

namespace spm::baker {
namespace {

namespace fs = std::filesystem;

/// Writers of this age are long done.
constexpr std::chrono::hours leftover_age(1);

struct CacheFile {
  std::string path;
  std::uint64_t bytes = 0;
  fs::file_time_type used;
  bool leftover = false;
};

bool is_digest(const std::string& name) {
  return name.size() == 64 && name.find_first_not_of("0123456789abcdef") == std::string::npos;
}

/// The files below a folder of a cache, in the order of their names. Others may come and go
/// meanwhile.
std::vector<CacheFile> files_of(const Cache& cache, const char* part) {
  std::vector<CacheFile> files;
  std::error_code problem;
  fs::recursive_directory_iterator at(fs::path(cache.folder()) / part, problem);
  for (; !problem && at != fs::recursive_directory_iterator(); at.increment(problem)) {
    std::error_code gone;
    if (!at->is_regular_file(gone)) continue;
    CacheFile file;
    file.path = at->path().string();
    file.bytes = at->file_size(gone);
    if (!gone) file.used = at->last_write_time(gone);
    if (gone) continue;
    file.leftover = !is_digest(at->path().filename().string());
    files.push_back(std::move(file));
  }
  std::sort(files.begin(), files.end(),
            [](const CacheFile& a, const CacheFile& b) { return a.path < b.path; });
  return files;
}

void remove_old(const std::vector<CacheFile>& files, bool all) {
  const auto limit = fs::file_time_type::clock::now() - leftover_age;
  std::error_code ignored;
  for (const CacheFile& file : files) {
    if ((all || file.leftover) && file.used < limit) fs::remove(file.path, ignored);
  }
}

/// Forgets what was built with keys whose entries are gone.
void forget_outputs(const Cache& cache) {
  std::error_code ignored;
  for (const CacheFile& file : files_of(cache, cache_outputs)) {
    const auto limit = fs::file_time_type::clock::now() - leftover_age;
    const auto digest = sha256_file(file.path);  // a note is the text that its key is the hash of
    if (digest && !cache.has(*digest) && file.used < limit) fs::remove(file.path, ignored);
  }
}

}  // namespace

CacheStats stats_of(const Cache& cache) {
  CacheStats stats;
  for (const CacheFile& file : files_of(cache, cache_entries)) {
    if (file.leftover) {
      ++stats.leftovers;
      continue;
    }
    ++stats.entries;
    stats.bytes += file.bytes;
  }
  for (const CacheFile& file : files_of(cache, cache_outputs)) {
    ++(file.leftover ? stats.leftovers : stats.outputs);
  }
  stats.leftovers += files_of(cache, cache_locks).size();
  return stats;
}

CachePruning prune(const Cache& cache, std::uint64_t max_bytes) {
  std::vector<CacheFile> files = files_of(cache, cache_entries);
  remove_old(files, false);
  files.erase(std::remove_if(files.begin(), files.end(),
                             [](const CacheFile& file) { return file.leftover; }),
              files.end());
  CachePruning pruning;
  for (const CacheFile& file : files) pruning.left_bytes += file.bytes;
  pruning.left = files.size();
  std::stable_sort(files.begin(), files.end(),
                   [](const CacheFile& a, const CacheFile& b) { return a.used < b.used; });
  for (const CacheFile& file : files) {
    if (pruning.left_bytes <= max_bytes) break;
    std::error_code problem;
    fs::remove(file.path, problem);
    if (problem) continue;
    ++pruning.removed;
    --pruning.left;
    pruning.removed_bytes += file.bytes;
    pruning.left_bytes -= file.bytes;
  }
  remove_old(files_of(cache, cache_outputs), false);
  remove_old(files_of(cache, cache_locks), true);
  forget_outputs(cache);
  return pruning;
}

CacheVerdict verify_cache(const Cache& cache) {
  CacheVerdict verdict;
  for (const CacheFile& file : files_of(cache, cache_entries)) {
    if (file.leftover) continue;
    ++verdict.entries;
    const auto found = cache.find(fs::path(file.path).filename().string());
    if (!found) verdict.problems.push_back(found.error().message);
  }
  return verdict;
}

}  // namespace spm::baker
