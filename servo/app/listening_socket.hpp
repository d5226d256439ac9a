// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>

#include "common/base/error.hpp"

namespace spm::servo {

/// The Unix socket at which applications find the daemon. Removes its file at the end.
class ListeningSocket {
 public:
  /// Listens at `path`. If that is empty, it listens at the socket of the daemon of that name in
  /// this user's own folder, which is made for this user alone if it does not exist. `group` may
  /// connect too, beside this user and root, and needs a path. A file that a daemon left behind is
  /// replaced. Errors: usage, for an invalid name or path; invalid_input, if a daemon answers
  /// there; file_or_device, if others could replace the socket (trusted_folder.hpp), and if the
  /// system refuses.
  [[nodiscard]] static Result<ListeningSocket> open(const std::string& path,
                                                    const std::string& name,
                                                    std::optional<gid_t> group = {});

  /// Whether another daemon answers at that place already. Errors: usage and invalid_input, as
  /// `open`. What else is wrong there is left to `open`.
  [[nodiscard]] static Result<void> check_free(const std::string& path, const std::string& name);

  ListeningSocket(ListeningSocket&& other) noexcept;
  ListeningSocket& operator=(ListeningSocket&&) = delete;
  ListeningSocket(const ListeningSocket&) = delete;
  ListeningSocket& operator=(const ListeningSocket&) = delete;
  /// Removes the file, unless another file took its place.
  ~ListeningSocket();

  /// Never blocks.
  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  ListeningSocket(int descriptor, std::string path) noexcept;

  int descriptor_ = -1;
  std::string path_;
  dev_t device_ = 0;  ///< of the file, to recognise it
  ino_t file_ = 0;
};

}  // namespace spm::servo
