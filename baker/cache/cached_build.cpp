// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/cache/cached_build.hpp"

#include <sys/resource.h>

#include <filesystem>
#include <system_error>

#include "baker/base/bake_error.hpp"
#include "baker/base/stopwatch.hpp"
#include "baker/cache/key_lock.hpp"
#include "formats/files/output_file.hpp"
#include "formats/files/sha256.hpp"
#include "formats/files/text_file.hpp"

namespace spm::baker {
namespace {

using Json = nlohmann::ordered_json;

/// What a build asks for, before it runs.
struct Wanted {
  CacheKey key;
  std::vector<std::string> derived;
};

Wanted wanted_of(const BuildRequest& request) {
  const Result<std::string> mesh = sha256_file(request.mesh);
  if (!mesh) throw BakeError(mesh.error().code, mesh.error().message);
  BuildRequest settled = request;
  Wanted wanted;
  wanted.derived = derive_limits(request.limits, request.mesh, settled.bake);
  wanted.key = cache_key(settled, *mesh);
  return wanted;
}

/// Why there is no entry for a key.
std::string why_missing(const Cache& cache, const BuildRequest& request, const CacheKey& key) {
  const Json before = cache.last_parts(request.output);
  if (!before.is_object()) return "this output was never built through this cache";
  const std::string changes = difference(before, key.parts);
  return changes.empty() ? "the entry was pruned" : changes;
}

bool holds(const std::string& path, const CacheEntry& entry) {
  std::error_code missing;
  if (std::filesystem::file_size(path, missing) != entry.asset.size() || missing) return false;
  const Result<std::string> hash = sha256_file(path);
  return hash && *hash == entry.asset_sha256;
}

/// The report of a build that another run did, as that of this one.
BuildReport delivered(const CacheEntry& entry, const Wanted& wanted, const BuildRequest& request,
                      Clock::time_point start) {
  const double load = seconds_since(start);
  const Clock::time_point writing = Clock::now();
  BuildReport report;
  const bool unchanged = holds(request.output, entry);
  if (!unchanged) {
    const Result<void> written = write_file(request.output, entry.asset);
    if (!written) throw BakeError(written.error().code, written.error().message);
  }
  report.json = entry.report;
  report.json["output"] = request.output;
  report.json["mesh"]["path"] = request.mesh;
  report.json["derived"] = wanted.derived;
  report.json["seconds"] = {{"load", load},  {"fit", 0.0},
                            {"cast", 0.0},   {"write", seconds_since(writing)},
                            {"verify", 0.0}, {"total", seconds_since(start)}};
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  report.json["threads"] = 1;
  report.json["peak_rss_bytes"] = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
  report.json["cache"] = "hit";
  report.json["cache_reason"] =
      unchanged ? "the same build, and the output has its bytes already" : "the same build";
  report.warnings = entry.warnings;
  report.notes = entry.notes;
  report.derived = wanted.derived;
  return report;
}

/// Keeps a finished build. The mesh may have changed since its key was made, and the output may be
/// another batch's by now: then the key is that of what was baked, or nothing is kept.
void keep(const Cache& cache, const BuildRequest& request, CacheKey key, BuildReport& report) {
  const auto mesh = report.json["mesh"]["sha256"].get<std::string>();
  if (key.parts["mesh"] != mesh) {
    key.parts["mesh"] = mesh;
    key.digest = sha256_bytes(key.parts.dump());
  }
  Result<std::string> bytes = read_text_file(request.output, "a baked file");
  CacheEntry entry;
  entry.asset_sha256 = report.json["content_sha256"].get<std::string>();
  if (!bytes || sha256_bytes(*bytes) != entry.asset_sha256) return;
  entry.asset = std::move(*bytes);
  entry.parts = key.parts;
  entry.report = report.json;
  entry.warnings = report.warnings;
  entry.notes = report.notes;
  if (const Result<void> stored = cache.store(key.digest, entry); !stored) {
    report.warnings.push_back("the cache keeps nothing of this bake: " + stored.error().message);
    return;
  }
  cache.keep_parts(request.output, key.parts);
}

/// A hit, or why there is none and what to warn of.
struct Lookup {
  std::optional<CacheEntry> entry;
  std::string reason, warning;
};

Lookup look_up(const Cache& cache, const BuildRequest& request, const CacheKey& key) {
  Lookup lookup;
  Result<std::optional<CacheEntry>> found = cache.find(key.digest);
  if (found) {
    lookup.entry = std::move(*found);
    if (!lookup.entry) lookup.reason = why_missing(cache, request, key);
    return lookup;
  }
  const bool corrupt = found.error().code == ExitCode::invalid_input;
  if (corrupt) cache.remove(key.digest);
  lookup.reason = corrupt ? "the entry was corrupt" : "the entry could not be read";
  lookup.warning = "an entry of the cache is baked anew: " + found.error().message;
  return lookup;
}

BuildReport hit(const Cache& cache, const CacheEntry& entry, const Wanted& wanted,
                const BuildRequest& request, Clock::time_point start) {
  BuildReport report = delivered(entry, wanted, request, start);
  cache.touch(wanted.key.digest);
  if (cache.last_parts(request.output) != wanted.key.parts) {
    cache.keep_parts(request.output, wanted.key.parts);
  }
  return report;
}

}  // namespace

BuildReport build_through(const Cache* cache, const BuildRequest& request,
                          const Progress& progress) {
  if (cache == nullptr) {
    BuildReport report = run_build(request, progress);
    report.json["cache"] = "off";
    return report;
  }
  const Clock::time_point start = Clock::now();
  check_paths(request);
  const Wanted wanted = wanted_of(request);
  Lookup lookup = look_up(*cache, request, wanted.key);
  if (lookup.entry) return hit(*cache, *lookup.entry, wanted, request, start);
  if (progress) progress("wait", 0);
  const KeyLock lock(cache->lock_path(wanted.key.digest));
  if (lock.waited()) {
    Lookup again = look_up(*cache, request, wanted.key);
    if (again.entry) return hit(*cache, *again.entry, wanted, request, start);
  }
  BuildReport report = run_build(request, progress);
  keep(*cache, request, wanted.key, report);
  if (!lookup.warning.empty()) report.warnings.push_back(lookup.warning);
  report.json["cache"] = "miss";
  report.json["cache_reason"] = lookup.reason;
  return report;
}

CacheForecast forecast(const Cache& cache, const BuildRequest& request) {
  const CacheKey key = wanted_of(request).key;
  if (cache.has(key.digest)) return {true, "the same build"};
  return {false, why_missing(cache, request, key)};
}

}  // namespace spm::baker
