// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace spm::servo {

/// Hands the newest value from one thread to one other. Neither ever waits: three slots are
/// exchanged, and values that were not taken are overwritten.
template <class Value>
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding): a cache line for each thread.
class LatestValue {
  static_assert(std::is_trivially_copyable_v<Value>);

 public:
  /// Called by the writing thread alone.
  void put(const Value& value) noexcept {
    slots_[own_by_putter_] = value;
    own_by_putter_ =
        between_.exchange(own_by_putter_ | fresh, std::memory_order_acq_rel) & slot_mask;
  }

  /// Called by the reading thread alone: whether a value was put since the last take.
  [[nodiscard]] bool is_fresh() const noexcept {
    return (between_.load(std::memory_order_relaxed) & fresh) != 0;
  }

  /// Called by the reading thread alone: true, with the newest value, if one was put since the last
  /// take.
  [[nodiscard]] bool take(Value& value) noexcept {
    if (!is_fresh()) return false;
    own_by_taker_ = between_.exchange(own_by_taker_, std::memory_order_acq_rel) & slot_mask;
    value = slots_[own_by_taker_];
    return true;
  }

 private:
  static constexpr std::uint32_t slot_mask = 3, fresh = 4;
  std::array<Value, 3> slots_{};
  alignas(64) std::uint32_t own_by_putter_ = 0;
  alignas(64) std::atomic<std::uint32_t> between_{1};
  alignas(64) std::uint32_t own_by_taker_ = 2;
};

}  // namespace spm::servo
