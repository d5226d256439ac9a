// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace spm::test {

/// Calls that a tick must not make, made by the current thread while `watch` is on: those of the
/// allocator, of locks, and of output. The program's own versions of these functions count them.
struct InterceptedCalls {
  std::uint64_t allocations = 0;
  std::uint64_t locks = 0;
  std::uint64_t writes = 0;
};

/// What was counted after `before`.
[[nodiscard]] constexpr InterceptedCalls operator-(const InterceptedCalls& after,
                                                   const InterceptedCalls& before) noexcept {
  return {after.allocations - before.allocations, after.locks - before.locks,
          after.writes - before.writes};
}

/// Turns the counting of the current thread on or off.
void watch(bool on) noexcept;

/// What the current thread counted so far.
[[nodiscard]] InterceptedCalls intercepted_calls() noexcept;

}  // namespace spm::test
