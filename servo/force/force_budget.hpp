// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

namespace spm {

/// How an object's force is computed in a tick.
enum class Care : std::uint8_t {
  exact,
  /// The object was touched in its last exact tick: the plane that it was touched at then stands
  /// for its surface, in its own frame.
  held,
  /// It was not, and its proxy may not look around as much as it would: it follows later.
  shortened,
};

/// How a tick's force was computed: exactly for `exact` objects that are there, from the number
/// `first` on and round to the start, and as cheaply as possible for the others.
struct ForceEffort {
  std::size_t first = 0;
  std::size_t exact = 0;
  std::size_t held = 0;       ///< of the others, by Care
  std::size_t shortened = 0;  ///< of the others, by Care

  /// Whether any answer is coarser than it would be with more time.
  [[nodiscard]] bool degraded() const noexcept { return held + shortened > 0; }
};

/// How many objects may be computed exactly: as long as the time lasts, or as many as it was in a
/// tick that is computed again. The default is all of them.
struct ForceBudget {
  using Clock = std::int64_t (*)() noexcept;
  static constexpr std::size_t any = std::numeric_limits<std::size_t>::max();

  Clock clock = nullptr;      ///< ns; null: time decides nothing
  std::int64_t until_ns = 0;  ///< of the clock: an object is begun before it, or is the first
  std::size_t first = any;    ///< where to begin; `any`: where the last tick stopped
  std::size_t most = any;     ///< objects

  /// That of a tick that was computed before.
  [[nodiscard]] static ForceBudget again(const ForceEffort& effort) noexcept {
    ForceBudget budget;
    if (!effort.degraded()) return budget;
    budget.first = effort.first;
    budget.most = effort.exact;
    return budget;
  }

  /// Whether one more object may be computed exactly, after `exact` of them.
  [[nodiscard]] bool allows(std::size_t exact) const noexcept {
    if (exact >= most) return false;
    return exact == 0 || clock == nullptr || clock() < until_ns;
  }
};

}  // namespace spm
