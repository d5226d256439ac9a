// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "servo/realtime/realtime.hpp"

namespace spm::servo {

/// While it lives, the kernel keeps every core out of idle states that take time to leave.
/// (/dev/cpu_dma_latency: 0 us is written, and holds as long as the file is open.)
class WakeupLatency {
 public:
  /// Asks for nothing where real time is off. Never an error: without permission `why` tells.
  [[nodiscard]] static WakeupLatency hold(RealtimeMode mode,
                                          const std::string& path = "/dev/cpu_dma_latency");

  WakeupLatency(WakeupLatency&& other) noexcept;
  WakeupLatency& operator=(WakeupLatency&&) = delete;
  WakeupLatency(const WakeupLatency&) = delete;
  WakeupLatency& operator=(const WakeupLatency&) = delete;
  ~WakeupLatency();

  [[nodiscard]] bool held() const noexcept { return descriptor_ >= 0; }
  /// Why it is not held, as a clause; empty if it is.
  [[nodiscard]] const std::string& why() const noexcept { return why_; }

 private:
  WakeupLatency(int descriptor, std::string why) noexcept;

  int descriptor_;
  std::string why_;
};

}  // namespace spm::servo
