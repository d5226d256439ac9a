// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/error.hpp"

namespace spm::baker {

struct RemoteOptions {
  std::string url;           ///< http or https, of the folder that the entries are in
  std::string token;         ///< sent as `Authorization: Bearer`; empty: none
  long timeout_seconds = 5;  ///< for a connection, and for silence or a crawl after it; 1 or more
};

/// Entries of a cache that several machines share: a plain HTTP store, in which each is an object
/// under its key (GET, HEAD, PUT). It only saves time: after the first failure, which is told once,
/// this object, its copies and all processes forked since leave the store alone. Nothing that comes
/// from it has been checked.
class RemoteCache {
 public:
  /// No connection is made. Errors: usage, for what is no such URL or token; internal.
  [[nodiscard]] static Result<RemoteCache> open(RemoteOptions options);

  /// The bytes under a key; nothing where the store has none or is left alone. Errors:
  /// file_or_device, the first time that the store cannot be read.
  [[nodiscard]] Result<std::optional<std::string>> get(const std::string& digest) const;

  /// Whether there are bytes under a key. Errors: as those of get.
  [[nodiscard]] Result<bool> has(const std::string& digest) const;

  /// Puts bytes under a key, in place of what is there. Errors: file_or_device, the first time that
  /// the store cannot be written, which it may well be read by then.
  [[nodiscard]] Result<void> put(const std::string& digest, std::string_view bytes) const;

  [[nodiscard]] std::string url_of(const std::string& digest) const;

 private:
  /// Lies in memory that forked processes share.
  struct LeftAlone {
    std::atomic<bool> reading = false, writing = false;
  };

  RemoteCache(RemoteOptions options, std::shared_ptr<LeftAlone> left_alone)
      : options_(std::move(options)), left_alone_(std::move(left_alone)) {}

  RemoteOptions options_;
  std::shared_ptr<LeftAlone> left_alone_;
};

/// The environment variable that holds the token.
inline constexpr const char* remote_token_variable = "SPM_REMOTE_CACHE_TOKEN";

}  // namespace spm::baker
