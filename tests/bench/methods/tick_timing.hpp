// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "common/base/vector.hpp"

namespace spm::bench {

/// What computes a force at each tick of a recorded path. Not for several threads.
class TickMethod {
 public:
  TickMethod() = default;
  virtual ~TickMethod() = default;
  TickMethod(const TickMethod&) = delete;
  TickMethod& operator=(const TickMethod&) = delete;

  /// Back to the path's first point, which is free.
  virtual void start(const Vector3& first) { static_cast<void>(first); }

  /// The tick's force; true in contact.
  virtual bool tick(std::size_t index, const Vector3& tool) = 0;

  /// Whether a tick is one that the figures count.
  [[nodiscard]] virtual bool counts(std::size_t index) const {
    static_cast<void>(index);
    return true;
  }
};

struct TickPlan {
  std::size_t passes = 9;
  double max_seconds = 6;      ///< of one method, after which it gets no further pass
  std::size_t min_passes = 3;  ///< whatever they take
};

/// Microseconds a tick.
struct TickTimes {
  double mean = 0, sd = 0, p50 = 0, p99 = 0;
  std::size_t ticks = 0, contacts = 0;
};

/// Times every tick by itself on one pinned core, the least of several passes, so that what the
/// machine does meanwhile is no part of it; methods in turn. The clock's own time is taken off.
[[nodiscard]] std::vector<TickTimes> time_ticks(
    std::span<const std::unique_ptr<TickMethod>> methods, std::span<const Vector3> path,
    const TickPlan& plan);

}  // namespace spm::bench
