// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

namespace spm::servo {

/// Lets one thread sleep until another has something for it, or until a time: what the standard's
/// atomic wait cannot, which has no end. Where nobody waits, raising it is no system call.
class ReportSignal {
 public:
  /// By one thread: after what it tells of was made visible to the waiting thread.
  void raise() noexcept;

  /// How often it was raised, around at 2^32; to be read before looking for what it tells of.
  [[nodiscard]] std::uint32_t count() const noexcept {
    return count_.load(std::memory_order_acquire);
  }

  /// By one other thread: sleeps while the count is `seen`; false where it still is at a time of
  /// now_ns(). Allocates nothing, and takes no lock.
  [[nodiscard]] bool wait(std::uint32_t seen, std::int64_t until_ns) noexcept;

 private:
  std::atomic<std::uint32_t> count_{0};
  std::atomic<bool> is_waited_for_{false};
};

}  // namespace spm::servo
