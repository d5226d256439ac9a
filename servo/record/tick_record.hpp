// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <readerwriterqueue/readerwriterqueue.h>

#include <cstddef>
#include <cstdint>

#include "common/base/hand_pose.hpp"
#include "common/base/wrench.hpp"
#include "formats/motion/recording.hpp"
#include "servo/force/force_budget.hpp"
#include "servo/safety/safety.hpp"

namespace spm::servo {

/// What one tick did to one device. The loop passes it to the statistics thread.
struct TickRecord {
  std::uint64_t tick = 0;  ///< index on the time grid
  std::uint32_t device = 0;
  std::int64_t wake_ns = 0;  ///< how late the loop woke up
  std::int64_t busy_ns = 0;  ///< from waking up to the write to the last device
  HandPose hand;             ///< hand's frame, as the force law had it
  Wrench wanted;             ///< result of the force law, about the hand's position
  Wrench added;              ///< by applications, to what is wanted
  Wrench sent;
  HandPose tool;     ///< world, of the tool that the hand holds
  double depth = 0;  ///< m
  std::uint32_t buttons = 0;
  bool contact = false;
  bool forgot = false;  ///< the force law had forgotten its state before this tick
  bool lost = false;    ///< records before this one were lost because the ring was full
  /// since the loop began, applications have moved, added or changed objects
  bool touched = false;
  bool edited = false;     ///< an edited scene was taken up before the forces of this tick
  bool exchanged = false;  ///< assets were opened, or opened again, before this tick
  bool kept = false;       ///< no force was sent, but the force law was asked and kept its state
  bool has_tool = false;   ///< `tool` is known
  bool force_capped = false, torque_capped = false;  ///< what was sent met the device's cap
  bool tool_leaving = false;                         ///< the tool is led out of what it lies in
  bool tool_capped = false;                          ///< the coupling of hand and tool met its cap
  std::uint16_t patches = 0;                         ///< places at which the tool touches
  ForceOff cause = ForceOff::none;
  ForceEffort effort;  ///< with which `wanted` was computed
};

/// A record in the form that files have.
[[nodiscard]] RecordingRow to_row(const TickRecord& record) noexcept;

/// Lock-free ring from the loop to the statistics thread.
using TickRing = moodycamel::ReaderWriterQueue<TickRecord>;

/// How many seconds of ticks the ring holds, for times when the statistics thread gets no
/// processor.
inline constexpr double ring_seconds = 8;

/// A ring of its full size whose pages were all touched, so that writing to it never faults.
[[nodiscard]] TickRing make_tick_ring(double rate_hz, std::size_t devices);

}  // namespace spm::servo
