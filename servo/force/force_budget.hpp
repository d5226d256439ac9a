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

  // Of a tool with six degrees of freedom. Its work is counted in samples that were looked at.
  static constexpr std::uint32_t unstopped = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t level = 0;  ///< coarser levels of the samples than the finest; 0: the finest
  /// Work after which time was over to look for contacts on finer levels; `unstopped`: it was not.
  std::uint32_t refined = unstopped;
  /// Work after which time was over to move the tool on.
  std::uint32_t worked = unstopped;
  std::uint32_t culled = 0;  ///< objects that were found apart from the tool as a whole

  /// Whether any answer is coarser than it would be with more time.
  [[nodiscard]] bool degraded() const noexcept {
    return held + shortened > 0 || level > 0 || stopped();
  }
  /// Whether the time of a tool was over before its work was done.
  [[nodiscard]] bool stopped() const noexcept {
    return refined != unstopped || worked != unstopped;
  }
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
  /// Of a tool: work after which its time is over, as in ForceEffort.
  std::uint32_t refined = ForceEffort::unstopped;
  std::uint32_t worked = ForceEffort::unstopped;

  /// That of a tick that was computed before.
  [[nodiscard]] static ForceBudget again(const ForceEffort& effort) noexcept {
    ForceBudget budget;
    budget.refined = effort.refined;
    budget.worked = effort.worked;
    if (effort.held + effort.shortened == 0) return budget;
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

/// What is left of a number of samples, after some.
[[nodiscard]] constexpr std::uint32_t work_left(std::uint32_t limit, std::uint32_t done) noexcept {
  if (limit == ForceEffort::unstopped) return limit;
  return limit > done ? limit - done : 0;
}

}  // namespace spm
