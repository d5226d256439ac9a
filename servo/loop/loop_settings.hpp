// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>

#include "servo/base/clock.hpp"
#include "servo/force/scene_force.hpp"

namespace spm::servo {

/// The share of a period that is for the exact forces of all devices. The rest is for coarser ones,
/// for sending and for being woken late.
inline constexpr double usual_tick_budget = 0.6;

/// Fixed while the loop runs.
struct LoopSettings {
  double rate_hz = 1000;
  std::uint64_t ticks = 0;  ///< stops after this many ticks of the grid; 0: when `stop` is set
  ForceScene scene = scene_of({});
  /// N, in addition to each device's own
  double force_cap = std::numeric_limits<double>::infinity();
  /// a tick follows each report of the first device instead of the clock
  bool paced_by_device = false;
  bool acknowledge = false;         ///< after a fault the force waits for an acknowledgement
  std::uint32_t enable_button = 0;  ///< without it held there is no force; from 1, 0: none
  /// of the period, above 0: when so much is over, objects that are left are computed more coarsely
  double tick_budget = usual_tick_budget;
  ForceBudget::Clock clock = now_ns;      ///< by which that is told
  ForceBudget::Clock asleep = asleep_ns;  ///< how long the machine has slept since it was started
  /// the machine is going to sleep: no force; null where nobody tells. It must outlive the loop.
  const std::atomic<bool>* sleeping = nullptr;
  /// where each tick leaves the time that it began, now_ns(), and the loop's end 0; null for
  /// nowhere. It must outlive the loop.
  std::atomic<std::int64_t>* beat = nullptr;
};

/// The largest stiffness that an object of a scene can have, N per metre of the hand.
[[nodiscard]] double stiffness_at_hand(const ForceScene& scene);

/// What the loop counted.
struct LoopCounters {
  std::uint64_t ticks = 0;    ///< that were run
  std::uint64_t missed = 0;   ///< not finished before the next one was due, including skipped ones
  std::uint64_t skipped = 0;  ///< missed ticks that were not run at all
  std::uint64_t contact_ticks = 0;   ///< with any device in contact
  std::uint64_t unrecorded = 0;      ///< records that did not fit into the full ring
  std::uint64_t degraded_ticks = 0;  ///< in which any object was computed more coarsely
  std::uint64_t page_faults = 0;     ///< in the loop's thread, from the first tick to the last
};

}  // namespace spm::servo
