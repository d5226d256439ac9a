// SPDX-License-Identifier: Apache-2.0
#include "servo/realtime/service_notice.hpp"

#include <systemd/sd-daemon.h>

#include <chrono>

#include "servo/realtime/realtime.hpp"

namespace spm::servo {

ServiceNotice::ServiceNotice(const std::atomic<std::int64_t>& beat) : beat_(beat) {
  std::uint64_t period_us = 0;
  if (sd_watchdog_enabled(0, &period_us) <= 0) return;
  const auto half_ns = static_cast<std::int64_t>(period_us) * 1000 / 2;
  thread_ = std::thread([this, half_ns] { feed(half_ns); });
}

ServiceNotice::~ServiceNotice() { end(); }

void ServiceNotice::feed(std::int64_t period_ns) {
  leave_realtime();
  std::int64_t told = 0;
  std::unique_lock lock(mutex_);
  while (!ends_) {
    const std::int64_t beat = beat_.load(std::memory_order_relaxed);
    if (beat != told) sd_notify(0, "WATCHDOG=1");
    told = beat;
    changed_.wait_for(lock, std::chrono::nanoseconds(period_ns), [this] { return ends_; });
  }
}

void ServiceNotice::end() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void ServiceNotice::ready() { sd_notify(0, "READY=1"); }

void ServiceNotice::stopping() {
  sd_notify(0, "STOPPING=1");
  end();
}

}  // namespace spm::servo
