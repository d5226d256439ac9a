// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <readerwriterqueue/readerwriterqueue.h>

#include <cstddef>
#include <cstdint>

#include "common/base/vector.hpp"
#include "formats/motion/recording.hpp"
#include "servo/safety/safety.hpp"

namespace spm::servo {

/// What one tick did to one device; what the loop tells the statistics thread.
struct TickRecord {
  std::uint64_t tick = 0;  ///< index on the time grid
  std::uint32_t device = 0;
  std::int64_t wake_ns = 0;            ///< how late the loop woke up
  std::int64_t busy_ns = 0;            ///< from waking up to the last device's write
  Vector3 position = Vector3::Zero();  ///< m
  Vector3 wanted = Vector3::Zero();    ///< N, what the force law said
  Vector3 force = Vector3::Zero();     ///< N, as sent
  double depth = 0;                    ///< m
  std::uint32_t buttons = 0;
  bool contact = false;
  bool forgot = false;   ///< the force law had forgotten what was before this tick
  bool lost = false;     ///< records before this one were lost, for the ring was full
  bool touched = false;  ///< applications have moved, added or changed objects since the loop began
  bool edited = false;   ///< an edited scene was taken up before this tick's forces
  ForceOff cause = ForceOff::none;
};

/// A record as files have it.
[[nodiscard]] RecordingRow to_row(const TickRecord& record) noexcept;

/// Lock-free ring from the loop to the statistics thread.
using TickRing = moodycamel::ReaderWriterQueue<TickRecord>;

/// Seconds of ticks that the ring holds while the statistics thread is kept off the processor.
inline constexpr double ring_seconds = 8;

/// A ring of its full size with every page touched, so that writing to it never faults.
[[nodiscard]] TickRing make_tick_ring(double rate_hz, std::size_t devices);

}  // namespace spm::servo
