// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

namespace spm::servo {

/// Lets one thread sleep until another has something for it, or until a time. The atomic wait of
/// the standard library has no time limit. If nobody waits, raising the signal makes no system
/// call.
class ReportSignal {
 public:
  /// Called by one thread, after what it announces was made visible to the waiting thread.
  void raise() noexcept;

  /// How often it was raised, modulo 2^32. Read it before looking for what it announces.
  [[nodiscard]] std::uint32_t count() const noexcept {
    return count_.load(std::memory_order_acquire);
  }

  /// Called by one other thread: sleeps while the count is `seen`. False if it still is at a time
  /// of now_ns(). Allocates nothing, and takes no lock.
  [[nodiscard]] bool wait(std::uint32_t seen, std::int64_t until_ns) noexcept;

 private:
  std::atomic<std::uint32_t> count_{0};
  std::atomic<bool> is_waited_for_{false};
};

}  // namespace spm::servo
