// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sched.h>

namespace spm::bench {

/// Keeps the calling thread on its current core until the object is destroyed. Does nothing if the
/// system refuses.
class OneCore {
 public:
  OneCore() {
    const int core = sched_getcpu();
    known_ = core >= 0 && sched_getaffinity(0, sizeof before_, &before_) == 0;
    if (!known_) return;
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<unsigned>(core), &one);
    sched_setaffinity(0, sizeof one, &one);
  }
  OneCore(const OneCore&) = delete;
  OneCore& operator=(const OneCore&) = delete;
  ~OneCore() {
    if (known_) sched_setaffinity(0, sizeof before_, &before_);
  }

 private:
  bool known_ = false;
  cpu_set_t before_{};
};

}  // namespace spm::bench
