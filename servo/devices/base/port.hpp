// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>

namespace spm::servo {

/// The result of waiting for a report.
enum class Received : std::uint8_t {
  report,   ///< one came
  nothing,  ///< none came in time, or it was incomplete or made no sense
  gone,     ///< the device was unplugged, or its connection can no longer be used
};

/// The longest time that a port waits for a report, so that its threads can be told to end.
inline constexpr std::chrono::milliseconds port_wait{20};

/// If no tick of the loop ran for this long, ns, a device is sent no force. It is twenty ticks at
/// the usual rate, more than a loop that still runs misses.
inline constexpr std::int64_t loop_stall_ns = 20'000'000;

/// One connection to a device, from its opening to its loss. A PortThreads calls `receive` from one
/// thread and `send` from another, at the same time. Both may block, allocate and lock.
template <class Report, class Command>
class Port {
 public:
  Port() = default;
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  virtual ~Port() = default;

  /// Waits for the next report, at most for port_wait.
  [[nodiscard]] virtual Received receive(Report& report) = 0;
  /// Sends a command. False if the connection can no longer be used.
  [[nodiscard]] virtual bool send(const Command& command) = 0;
};

}  // namespace spm::servo
