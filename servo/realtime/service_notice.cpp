// SPDX-License-Identifier: Apache-2.0
#include "servo/realtime/service_notice.hpp"

#include <systemd/sd-daemon.h>

#include "servo/base/clock.hpp"

namespace spm::servo {

ServiceNotice::ServiceNotice() {
  std::uint64_t period_us = 0;
  if (sd_watchdog_enabled(0, &period_us) > 0) {
    period_ns_ = static_cast<std::int64_t>(period_us) * 1000 / 2;
  }
}

void ServiceNotice::ready() { sd_notify(0, "READY=1"); }

void ServiceNotice::alive(std::int64_t beat) {
  const std::int64_t now = now_ns();
  if (period_ns_ == 0 || beat == told_beat_ || now - told_ns_ < period_ns_) return;
  told_ns_ = now;
  told_beat_ = beat;
  sd_notify(0, "WATCHDOG=1");
}

void ServiceNotice::stopping() { sd_notify(0, "STOPPING=1"); }

}  // namespace spm::servo
