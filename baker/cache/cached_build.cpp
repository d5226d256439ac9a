// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/cache/cached_build.hpp"

#include <sys/resource.h>

#include <filesystem>
#include <system_error>

#include "baker/base/bake_error.hpp"
#include "baker/base/stopwatch.hpp"
#include "baker/cache/entry_check.hpp"
#include "baker/cache/key_lock.hpp"
#include "baker/mesh/mesh_files.hpp"
#include "formats/files/output_file.hpp"
#include "formats/files/sha256.hpp"
#include "formats/files/text_file.hpp"

namespace spm::baker {
namespace {

using Json = nlohmann::ordered_json;

/// What a build asks for, before it runs.
// NOLINTNEXTLINE(bugprone-exception-escape): a JSON value allocates while it is destroyed.
struct Wanted {
  CacheKey key;
  std::vector<std::string> derived;
};

Wanted wanted_of(const BuildRequest& request) {
  const Result<std::string> mesh = mesh_sha256(request.mesh, request.load.outside_buffers);
  if (!mesh) throw BakeError(mesh.error().code, mesh.error().message);
  BuildRequest settled = request;
  Wanted wanted;
  wanted.derived = derive_limits(request.limits, request.mesh, settled.bake, settled.load.open_as);
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
    make_folder_of(request.output);
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

/// Keeps the bytes of an entry in the folder, and tells where that fails.
void store(const Cache& cache, const std::string& digest, const std::string& bytes,
           BuildReport& report) {
  if (const Result<void> stored = cache.store(digest, bytes); !stored) {
    report.warnings.push_back("the cache keeps nothing of this bake: " + stored.error().message);
  }
}

/// Keeps a finished build, here and where others share it. The mesh may have changed since its key
/// was made, and the output may be another batch's by now: then the key is that of what was baked,
/// or nothing is kept.
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
  const std::string encoded = entry_bytes(entry);
  store(cache, key.digest, encoded, report);
  cache.keep_parts(request.output, key.parts);
  if (cache.remote() == nullptr) return;
  if (const Result<void> sent = cache.remote()->put(key.digest, encoded); !sent) {
    report.warnings.push_back(sent.error().message);
  }
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

/// Asks the remote cache. What it has is believed only where it stands a check.
Lookup ask_remote(const Cache& cache, const BuildRequest& request, const CacheKey& key,
                  const Progress& progress) {
  Lookup lookup;
  if (cache.remote() == nullptr) return lookup;
  if (progress) progress("fetch", 0);
  Result<std::optional<std::string>> bytes = cache.remote()->get(key.digest);
  if (!bytes) lookup.warning = bytes.error().message;
  if (!bytes || !*bytes) return lookup;
  const std::string url = cache.remote()->url_of(key.digest);
  Result<CacheEntry> entry = parse_cache_entry(url, std::move(**bytes));
  const Result<void> fits =
      entry ? check_entry(*entry, key.parts, request) : tl::make_unexpected(entry.error());
  if (!fits) {
    lookup.reason = "the remote entry was refused";
    lookup.warning = "an entry of the remote cache is refused, and baked anew: " +
                     (entry ? url + ": " : std::string()) + fits.error().message;
    return lookup;
  }
  lookup.entry = std::move(*entry);
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
  Lookup remote = ask_remote(*cache, request, wanted.key, progress);
  BuildReport report;
  if (remote.entry) {
    report = hit(*cache, *remote.entry, wanted, request, start);
    store(*cache, wanted.key.digest, entry_bytes(*remote.entry), report);
    report.json["cache_reason"] = "the same build, from the remote cache";
  } else {
    report = run_build(request, progress);
    keep(*cache, request, wanted.key, report);
    report.json["cache"] = "miss";
    report.json["cache_reason"] = remote.reason.empty() ? lookup.reason : remote.reason;
  }
  for (const std::string* warning : {&lookup.warning, &remote.warning}) {
    if (!warning->empty()) report.warnings.push_back(*warning);
  }
  return report;
}

CacheForecast forecast(const Cache& cache, const BuildRequest& request) {
  const CacheKey key = wanted_of(request).key;
  if (cache.has(key.digest)) return {true, "the same build"};
  const Result<bool> remote = cache.remote() == nullptr ? false : cache.remote()->has(key.digest);
  if (!remote) return {false, remote.error().message};
  if (*remote) return {true, "the same build, from the remote cache"};
  return {false, why_missing(cache, request, key)};
}

}  // namespace spm::baker
