// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace spm::servo {

/// Tells a service manager (systemd) how this program is. Does nothing if none started it. Every
/// call may block for a short time; not for a tick.
class ServiceNotice {
 public:
  ServiceNotice();

  /// The program serves now.
  void ready();
  /// Call it often, with the time of the loop's last tick, now_ns(): the manager's watchdog is told
  /// that all is well, at half its period, if the loop has ticked since it was last told.
  void alive(std::int64_t beat);
  /// The program ends.
  void stopping();

 private:
  std::int64_t period_ns_ = 0;  ///< of the messages; 0: the manager has no watchdog
  std::int64_t told_ns_ = 0, told_beat_ = 0;
};

}  // namespace spm::servo
