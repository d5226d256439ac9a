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

/// A place to ask at, and where a proxy that starts afresh is put before.
struct TimedPlace {
  Vector3 point = Vector3::Zero();
  Vector3 free = Vector3::Zero();  ///< on the surface's free side
  bool fresh = true;               ///< not one step from the place before
};

/// What every method is asked: one set for all of them.
struct QuerySets {
  std::vector<TimedPlace> hot;     ///< along a path
  std::vector<TimedPlace> random;  ///< in no order
};

/// What is timed. `ask` is called with whole blocks, so that neither clock nor call weighs.
class Contestant {
 public:
  Contestant() = default;
  virtual ~Contestant() = default;
  Contestant(const Contestant&) = delete;
  Contestant& operator=(const Contestant&) = delete;

  /// Before a block, not timed: brings what remembers to the block's first place.
  virtual void begin(std::span<const TimedPlace> block) = 0;

  /// Asks at every place of the block that was begun, in order.
  virtual void ask(std::span<const TimedPlace> block) = 0;
};

struct TimingPlan {
  std::size_t rounds = 15;         ///< passes of each contestant, in turn
  double pass_seconds = 0.015;     ///< a pass of a slow one is cut to as many blocks as this takes
  std::size_t cold_queries = 100;  ///< of each contestant
  std::size_t cold_bytes = 48u << 20u;  ///< walked before each of them
};

/// Nanoseconds a query.
struct QueryTimes {
  double hot = 0, random = 0, cold = 0;
};

/// Holds this thread to the processor it runs on while it lives.
class PinnedThread {
 public:
  PinnedThread();
  ~PinnedThread();
  PinnedThread(const PinnedThread&) = delete;
  PinnedThread& operator=(const PinnedThread&) = delete;

 private:
  std::vector<std::uint8_t> before_;
};

/// What reading the clock twice takes, s: the median of many.
[[nodiscard]] double clock_seconds();

/// Times all contestants on one pinned core, in rounds, so that what the machine does meanwhile
/// hits all alike. Hot and random: the median over a pass's blocks of 64 queries, then over the
/// passes. Each pass goes once over its blocks beforehand, so that hot is hot. Cold: the median
/// over single queries at random places, a buffer larger than the caches walked before each. The
/// clock's own time is taken off.
[[nodiscard]] std::vector<QueryTimes> time_queries(
    const std::vector<std::unique_ptr<Contestant>>& contestants, const QuerySets& sets,
    const TimingPlan& plan, const std::function<void(double done)>& progress);

/// The hot figures alone.
[[nodiscard]] std::vector<double> time_hot(
    const std::vector<std::unique_ptr<Contestant>>& contestants, std::span<const TimedPlace> places,
    const TimingPlan& plan);

/// Keeps the compiler from leaving out what nobody reads.
template <class T>
void keep(const T& value) {
  asm volatile("" : : "g"(&value) : "memory");
}

}  // namespace spm::bench
