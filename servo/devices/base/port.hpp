// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>

namespace spm::servo {

/// What became of waiting for a report.
enum class Received : std::uint8_t {
  report,   ///< one came
  nothing,  ///< none came in time, or only part of one, or one that made no sense
  gone,     ///< the device was unplugged, or its connection cannot be used any longer
};

/// How long a port waits for a report at most, so that its threads can be told to end.
inline constexpr std::chrono::milliseconds port_wait{20};

/// One connection to a device, from its opening to its loss. A PortThreads calls `receive` from one
/// thread and `send` from another, at the same time; both may block, allocate and lock.
template <class Report, class Command>
class Port {
 public:
  Port() = default;
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  virtual ~Port() = default;

  /// Waits for the next report, at most port_wait.
  [[nodiscard]] virtual Received receive(Report& report) = 0;
  /// Sends a command; false where the connection cannot be used any longer.
  [[nodiscard]] virtual bool send(const Command& command) = 0;
};

}  // namespace spm::servo
