// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "servo/safety/device_counters.hpp"

namespace spm::servo {

/// What applications learn of a tick when it is over and its duration is known.
struct AppLoop {
  std::int64_t time_ns = 0;  ///< when it began, of CLOCK_MONOTONIC
  std::int64_t wake_ns = 0;  ///< how late that was
  std::int64_t busy_ns = 0;  ///< how long it worked
  // Since the loop began, this tick included:
  std::uint64_t ticks = 0;    ///< that were run
  std::uint64_t missed = 0;   ///< not finished before the next one was due, including skipped ones
  std::uint64_t skipped = 0;  ///< missed ticks that were not run at all
  std::span<const DeviceCounters> devices;  ///< at most SPM_MAX_DEVICES are published
  std::uint64_t degraded = 0;               ///< ticks that had too little time for all objects
};

}  // namespace spm::servo
