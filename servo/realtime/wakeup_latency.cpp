// SPDX-License-Identifier: Apache-2.0
#include "servo/realtime/wakeup_latency.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <utility>

namespace spm::servo {

WakeupLatency WakeupLatency::hold(RealtimeMode mode, const std::string& path) {
  if (mode == RealtimeMode::off) return {-1, "real time was not asked for"};
  const int descriptor = open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) return {-1, path + ": " + std::strerror(errno)};
  const std::int32_t longest_us = 0;
  if (write(descriptor, &longest_us, sizeof longest_us) == sizeof longest_us) {
    return {descriptor, ""};
  }
  std::string why = path + ": " + std::strerror(errno);
  close(descriptor);
  return {-1, std::move(why)};
}

WakeupLatency::WakeupLatency(int descriptor, std::string why) noexcept
    : descriptor_(descriptor), why_(std::move(why)) {}

WakeupLatency::WakeupLatency(WakeupLatency&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), why_(std::move(other.why_)) {}

WakeupLatency::~WakeupLatency() {
  if (descriptor_ >= 0) close(descriptor_);
}

}  // namespace spm::servo
