// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "baker/cache/cache_key.hpp"
#include "baker/cache/remote_cache.hpp"
#include "common/base/error.hpp"

namespace spm::baker {

/// A finished build as the cache keeps it.
// NOLINTNEXTLINE(bugprone-exception-escape): a JSON value allocates while it is destroyed.
struct CacheEntry {
  nlohmann::ordered_json parts;   ///< of its key
  nlohmann::ordered_json report;  ///< of build
  std::vector<std::string> warnings, notes;
  std::string asset_sha256;
  std::string asset;  ///< the bytes of the baked file
};

/// A folder of finished builds under their keys (README.md). Many processes, also of several
/// machines, may use it at once, and any of them may be killed at any moment: an entry is one file,
/// which appears whole or not at all and carries a checksum of its own.
class Cache {
 public:
  /// Opens a cache; makes one where there is no folder or an empty one. Errors: file_or_device;
  /// invalid_input for a folder that holds other things.
  [[nodiscard]] static Result<Cache> open(const std::string& folder, bool create = true);

  /// The entry of a key, checked; nothing where there is none. Errors: file_or_device, for an entry
  /// that cannot be read; invalid_input, for one that is not whole.
  [[nodiscard]] Result<std::optional<CacheEntry>> find(const std::string& digest) const;

  /// Whether there is an entry, checked or not.
  [[nodiscard]] bool has(const std::string& digest) const;

  /// Keeps an entry, given as its bytes. Errors: file_or_device.
  [[nodiscard]] Result<void> store(const std::string& digest, const std::string& entry) const;

  /// Removes an entry that is not whole.
  void remove(const std::string& digest) const;

  /// Notes that an entry was used, for `prune`.
  void touch(const std::string& digest) const;

  /// The parts of the last key with which an output was built through this cache; null where none
  /// was. They only explain misses.
  [[nodiscard]] nlohmann::ordered_json last_parts(const std::string& output) const;
  void keep_parts(const std::string& output, const nlohmann::ordered_json& parts) const;

  [[nodiscard]] const std::string& folder() const { return folder_; }
  [[nodiscard]] std::string entry_path(const std::string& digest) const;
  [[nodiscard]] std::string lock_path(const std::string& digest) const;

  /// Where entries come from that are not in the folder, and go to as well; null: nowhere.
  void set_remote(RemoteCache remote) { remote_ = std::move(remote); }
  [[nodiscard]] const RemoteCache* remote() const { return remote_ ? &*remote_ : nullptr; }

 private:
  explicit Cache(std::string folder) : folder_(std::move(folder)) {}

  [[nodiscard]] std::string output_path(const std::string& output) const;

  std::string folder_;
  std::optional<RemoteCache> remote_;
};

/// The folders of a cache.
inline constexpr const char* cache_entries = "entries";
inline constexpr const char* cache_outputs = "outputs";
inline constexpr const char* cache_locks = "locks";

/// An entry as a file or a store has it.
[[nodiscard]] std::string entry_bytes(const CacheEntry& entry);

/// Reads the bytes of an entry and checks them; `path` is for messages. Errors: invalid_input.
[[nodiscard]] Result<CacheEntry> parse_cache_entry(const std::string& path, std::string bytes);

}  // namespace spm::baker
