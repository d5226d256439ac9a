// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "common/base/vector.hpp"

namespace spm::bench {

/// A method that computes a force at each tick of a recorded path. Not thread-safe.
class TickMethod {
 public:
  TickMethod() = default;
  virtual ~TickMethod() = default;
  TickMethod(const TickMethod&) = delete;
  TickMethod& operator=(const TickMethod&) = delete;

  /// Returns to the first point of the path, which is in free space.
  virtual void start(const Vector3& first) { static_cast<void>(first); }

  /// Computes the force at a tick; true in contact.
  virtual bool tick(std::size_t index, const Vector3& tool) = 0;

  /// Whether the figures include a tick.
  [[nodiscard]] virtual bool counts(std::size_t index) const {
    static_cast<void>(index);
    return true;
  }
};

struct TickPlan {
  std::size_t passes = 9;
  double max_seconds = 6;      ///< a method gets no further pass after this time
  std::size_t min_passes = 3;  ///< however long they take
};

/// Microseconds per tick.
struct TickTimes {
  double mean = 0, sd = 0, p50 = 0, p99 = 0;
  std::size_t ticks = 0, contacts = 0;
};

/// Times every tick separately on one pinned core and takes the least time of several passes, which
/// leaves out other load on the machine. The methods take turns. Subtracts the clock's own time.
[[nodiscard]] std::vector<TickTimes> time_ticks(
    std::span<const std::unique_ptr<TickMethod>> methods, std::span<const Vector3> path,
    const TickPlan& plan);

}  // namespace spm::bench
