// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "common/base/vector.hpp"

namespace spm::bench {

/// A place to query, and the place where a proxy is put before if it starts afresh.
struct TimedPlace {
  Vector3 point = Vector3::Zero();
  Vector3 free = Vector3::Zero();  ///< on the surface's free side
  bool fresh = true;               ///< not one step from the place before
};

/// The queries for every method; all methods get the same set.
struct QuerySets {
  std::vector<TimedPlace> hot;     ///< along a path
  std::vector<TimedPlace> random;  ///< in random order
};

/// A timed method. `ask` gets whole blocks, so that the cost of the clock and the call is small.
class Contestant {
 public:
  Contestant() = default;
  virtual ~Contestant() = default;
  Contestant(const Contestant&) = delete;
  Contestant& operator=(const Contestant&) = delete;

  /// Runs before a block, not timed: moves a method with state to the first place of the block.
  virtual void begin(std::span<const TimedPlace> block) = 0;

  /// Instead of begin, before a single place that goes on from the one before.
  virtual void go_on(std::span<const TimedPlace> place) { begin(place); }

  /// Queries every place of the block that was begun, in order.
  virtual void ask(std::span<const TimedPlace> block) = 0;
};

struct TimingPlan {
  std::size_t rounds = 15;              ///< passes of each contestant, in turn
  double pass_seconds = 0.015;          ///< a slow pass is cut to the blocks that fit in this time
  std::size_t single_passes = 3;        ///< over the path, each query timed by itself
  std::size_t cold_queries = 100;       ///< of each contestant
  std::size_t cold_bytes = 48u << 20u;  ///< read before each of them
};

/// Nanoseconds per query.
struct QueryTimes {
  double hot = 0, hot_p99 = 0, random = 0, cold = 0;
};

/// Pins this thread to its current processor during the lifetime of the object.
class PinnedThread {
 public:
  PinnedThread();
  ~PinnedThread();
  PinnedThread(const PinnedThread&) = delete;
  PinnedThread& operator=(const PinnedThread&) = delete;

 private:
  std::vector<std::uint8_t> before_;
};

/// Time to read the clock twice, s: the median of many measurements.
[[nodiscard]] double clock_seconds();

/// Times all contestants on one pinned core, in rounds, so that other load on the machine affects
/// all of them equally. Hot and random: the median over a pass's blocks of 64 queries, then over
/// the passes. Each pass first runs once over its blocks to warm the caches. hot_p99: over single
/// queries along the path, of each the least of several passes, which leaves out other load on the
/// machine; passes of slow methods end early, after as long as all their rounds. Cold: the median
/// over single queries at random places; before each, a buffer larger than the caches is read. The
/// clock's own time is subtracted.
[[nodiscard]] std::vector<QueryTimes> time_queries(
    const std::vector<std::unique_ptr<Contestant>>& contestants, const QuerySets& sets,
    const TimingPlan& plan, const std::function<void(double done)>& progress);

/// Only the hot figures.
[[nodiscard]] std::vector<double> time_hot(
    const std::vector<std::unique_ptr<Contestant>>& contestants, std::span<const TimedPlace> places,
    const TimingPlan& plan);

/// Keeps the compiler from removing a value that is never read.
template <class T>
void keep(const T& value) {
  asm volatile("" : : "g"(&value) : "memory");
}

}  // namespace spm::bench
