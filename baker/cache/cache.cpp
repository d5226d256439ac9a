// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/cache/cache.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "formats/files/json_text.hpp"
#include "formats/files/output_file.hpp"
#include "formats/files/sha256.hpp"
#include "formats/files/text_file.hpp"

namespace spm::baker {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// bford.info/cachedir: programs that make backups leave such folders out.
constexpr const char* tag_name = "CACHEDIR.TAG";
constexpr const char* tag_text =
    "Signature: 8a477f597d28d172789f06886806bc55\n"
    "# This folder is a cache of spm-bake; it may be deleted at any time.\n";
constexpr std::string_view entry_mark = "spm-bake cache entry 1 ";
constexpr std::size_t digest_length = 64;

tl::unexpected<Error> broken(const std::string& path, const std::string& what) {
  return fail(ExitCode::invalid_input, path + ": " + what);
}

/// The JSON object of an entry, between its first line and the asset.
Json head_of(const CacheEntry& entry) {
  return {{"key", entry.parts},
          {"report", entry.report},
          {"warnings", entry.warnings},
          {"notes", entry.notes},
          {"asset_sha256", entry.asset_sha256},
          {"asset_bytes", entry.asset.size()}};
}

}  // namespace

std::string entry_bytes(const CacheEntry& entry) {
  const std::string content = head_of(entry).dump() + "\n" + entry.asset;
  return std::string(entry_mark) + sha256_bytes(content) + "\n" + content;
}

Result<CacheEntry> parse_cache_entry(const std::string& path, std::string bytes) {
  const std::string_view whole = bytes;
  const std::size_t start = entry_mark.size() + digest_length + 1;
  if (!whole.starts_with(entry_mark) || whole.size() < start || whole[start - 1] != '\n') {
    return broken(path, "does not begin as an entry of this version");
  }
  const std::string_view content = whole.substr(start);
  if (whole.substr(entry_mark.size(), digest_length) != sha256_bytes(content)) {
    return broken(path, "its checksum is wrong");
  }
  const std::size_t end = content.find('\n');
  const Json head = parse_json<Json>(content.substr(0, end));
  if (!head.is_object() || end == std::string_view::npos) return broken(path, "has no description");
  try {
    CacheEntry entry;
    entry.parts = head.at("key");
    entry.report = head.at("report");
    entry.warnings = head.at("warnings").get<std::vector<std::string>>();
    entry.notes = head.at("notes").get<std::vector<std::string>>();
    entry.asset_sha256 = head.at("asset_sha256").get<std::string>();
    const auto asset_bytes = head.at("asset_bytes").get<std::size_t>();
    bytes.erase(0, start + end + 1);
    entry.asset = std::move(bytes);
    if (entry.asset.size() != asset_bytes) return broken(path, "its asset has another size");
    return entry;
  } catch (const Json::exception& problem) {
    return broken(path, std::string("its description is incomplete: ") + problem.what());
  }
}

Result<Cache> Cache::open(const std::string& folder, bool create) {
  std::error_code problem;
  const fs::path path(folder);
  if (fs::exists(path / tag_name, problem)) {
    const Result<std::string> tag = read_text_file((path / tag_name).string(), "a cache's tag");
    if (!tag) return tl::make_unexpected(tag.error());
    if (tag->find("spm-bake") != std::string::npos) return Cache(folder);
  } else if (create && (!fs::exists(path, problem) || fs::is_empty(path, problem) ||
                        fs::exists(path / cache_entries, problem))) {
    fs::create_directories(path / cache_entries, problem);
    if (!problem) fs::create_directories(path / cache_outputs, problem);
    if (!problem) fs::create_directories(path / cache_locks, problem);
    if (problem) {
      return fail(ExitCode::file_or_device,
                  folder + ": no cache can be made there: " + problem.message() +
                      "; give a folder that can be written");
    }
    if (const auto written = write_file((path / tag_name).string(), tag_text); !written) {
      return tl::make_unexpected(written.error());
    }
    return Cache(folder);
  } else if (!fs::exists(path, problem)) {
    return fail(ExitCode::file_or_device, folder + ": there is no such folder; check the name");
  }
  return fail(ExitCode::invalid_input,
              folder + ": holds other things than a cache of spm-bake; give a folder of its own");
}

std::string Cache::entry_path(const std::string& digest) const {
  return (fs::path(folder_) / cache_entries / digest.substr(0, 2) / digest).string();
}

std::string Cache::lock_path(const std::string& digest) const {
  return (fs::path(folder_) / cache_locks / digest).string();
}

std::string Cache::output_path(const std::string& output) const {
  std::error_code ignored;
  const std::string name = sha256_bytes(fs::weakly_canonical(output, ignored).string());
  return (fs::path(folder_) / cache_outputs / name.substr(0, 2) / name).string();
}

bool Cache::has(const std::string& digest) const {
  std::error_code ignored;
  return fs::exists(entry_path(digest), ignored);
}

Result<std::optional<CacheEntry>> Cache::find(const std::string& digest) const {
  if (!has(digest)) return std::optional<CacheEntry>();
  const std::string path = entry_path(digest);
  Result<std::string> bytes = read_text_file(path, "an entry of a cache");
  if (!bytes) return tl::make_unexpected(bytes.error());
  Result<CacheEntry> entry = parse_cache_entry(path, std::move(*bytes));
  if (!entry) return tl::make_unexpected(entry.error());
  // An entry under the name of another one must not be served.
  if (sha256_bytes(entry->parts.dump()) != digest) {
    return broken(path, "is that of another key");
  }
  return std::optional<CacheEntry>(std::move(*entry));
}

Result<void> Cache::store(const std::string& digest, const std::string& entry) const {
  const std::string path = entry_path(digest);
  std::error_code ignored;
  fs::create_directories(fs::path(path).parent_path(), ignored);
  return write_file(path, entry);
}

void Cache::remove(const std::string& digest) const {
  std::error_code ignored;
  fs::remove(entry_path(digest), ignored);
}

void Cache::touch(const std::string& digest) const {
  ::utimensat(AT_FDCWD, entry_path(digest).c_str(), nullptr, 0);
}

Json Cache::last_parts(const std::string& output) const {
  std::error_code ignored;
  const std::string path = output_path(output);
  if (!fs::exists(path, ignored)) return {};
  const Result<std::string> text = read_text_file(path, "a cache's note");
  const Json parts = text ? parse_json<Json>(*text) : Json();
  return parts.is_object() ? parts : Json();
}

void Cache::keep_parts(const std::string& output, const Json& parts) const {
  const std::string path = output_path(output);
  std::error_code ignored;
  fs::create_directories(fs::path(path).parent_path(), ignored);
  static_cast<void>(write_file(path, parts.dump()));
}

}  // namespace spm::baker
