// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstddef>
#include <mutex>

#include "baker/base/progress.hpp"

namespace spm::baker {

/// Counts finished pieces of a parallel stage, and reports the progress now and then.
class ProgressCounter {
 public:
  ProgressCounter(const Progress& progress, const char* stage, std::size_t total)
      : progress_(progress), stage_(stage), total_(total) {}

  void done() {
    const std::size_t finished = ++finished_;
    if (!progress_ || total_ == 0) return;
    // A thread that cannot have the lock at once leaves the report to the thread that has it.
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (lock) progress_(stage_, static_cast<double>(finished) / static_cast<double>(total_));
  }

 private:
  const Progress& progress_;
  const char* stage_;
  std::size_t total_;
  std::atomic<std::size_t> finished_{0};
  std::mutex mutex_;
};

}  // namespace spm::baker
