// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <string>

#include "common/base/error.hpp"

namespace spm::servo {

/// The Unix socket at which applications find the daemon; its file goes with it.
class ListeningSocket {
 public:
  /// Listens at `path`; where that is empty, at the socket of the daemon of that name in this
  /// user's own folder, which is made where it is not there, for this user alone. A file that a
  /// daemon left behind is replaced. Errors: usage for a name or path that cannot be one;
  /// file_or_device where a daemon answers there, where the folder belongs to somebody else or is
  /// open to others, and where the system refuses.
  [[nodiscard]] static Result<ListeningSocket> open(const std::string& path,
                                                    const std::string& name);

  ListeningSocket(ListeningSocket&& other) noexcept;
  ListeningSocket& operator=(ListeningSocket&&) = delete;
  ListeningSocket(const ListeningSocket&) = delete;
  ListeningSocket& operator=(const ListeningSocket&) = delete;
  /// Removes the file, unless another one took its place.
  ~ListeningSocket();

  /// Never blocks.
  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  ListeningSocket(int descriptor, std::string path) noexcept;

  int descriptor_ = -1;
  std::string path_;
  dev_t device_ = 0;  ///< of the file, to know it again
  ino_t file_ = 0;
};

}  // namespace spm::servo
