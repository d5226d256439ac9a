// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/cache/key_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace spm::baker {
namespace {

/// Takes the lock of an open file; false where that cannot be done.
bool lock(int descriptor, bool& waited) {
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return true;
  if (errno != EWOULDBLOCK) return false;
  waited = true;
  while (::flock(descriptor, LOCK_EX) != 0) {
    if (errno != EINTR) return false;
  }
  return true;
}

/// Whether an open file still has its name: whoever held the lock before has taken it away.
bool still_named(int descriptor, const std::string& path) {
  struct stat open_file {
  }, named{};
  return ::fstat(descriptor, &open_file) == 0 && ::stat(path.c_str(), &named) == 0 &&
         open_file.st_dev == named.st_dev && open_file.st_ino == named.st_ino;
}

}  // namespace

KeyLock::KeyLock(std::string path) : path_(std::move(path)) {
  for (;;) {
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor_ < 0) return;
    const bool held = lock(descriptor_, waited_);
    if (held && still_named(descriptor_, path_)) return;
    ::close(std::exchange(descriptor_, -1));
    if (!held) return;
  }
}

KeyLock::~KeyLock() {
  if (descriptor_ < 0) return;
  ::unlink(path_.c_str());  // while it is held, so that nobody else takes the lock of a lost name
  ::close(descriptor_);
}

}  // namespace spm::baker
