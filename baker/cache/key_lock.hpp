// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace spm::baker {

/// Held by whoever bakes for a key, so that nobody else bakes the same thing meanwhile. It ends
/// with its process. Where a file system has no locks nothing is held: then two may bake the same
/// thing, with the same result.
class KeyLock {
 public:
  /// Waits until nobody else holds the lock of a path.
  explicit KeyLock(std::string path);
  ~KeyLock();
  KeyLock(const KeyLock&) = delete;
  KeyLock& operator=(const KeyLock&) = delete;

  /// True where another process held it at first.
  [[nodiscard]] bool waited() const { return waited_; }

 private:
  std::string path_;
  int descriptor_ = -1;
  bool waited_ = false;
};

}  // namespace spm::baker
