// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/delay_watch.hpp"

#include <algorithm>
#include <cmath>

#include "common/contact/stabilization_settings.hpp"
#include "common/contact/stable_stiffness.hpp"

namespace spm::servo {

DelayWatch::DelayWatch(double tick, double own_delay) noexcept
    : tick_(tick),
      own_ticks_(own_delay / tick),
      measured_(own_ticks_),
      counted_(rounded(own_ticks_)) {}

double DelayWatch::rounded(double ticks) noexcept {
  return std::clamp(step * std::ceil(ticks / step), border_delay_ticks, max_delay_ticks);
}

bool DelayWatch::look(const DelayCounts& counts) noexcept {
  const std::uint64_t readings = counts.readings - before_.readings;
  if (readings < window) return false;
  const std::uint64_t commands = counts.commands - before_.commands;
  double ns = static_cast<double>(counts.age_ns - before_.age_ns) / static_cast<double>(readings);
  if (commands > 0) {
    ns += static_cast<double>(counts.sent_ns - before_.sent_ns) / static_cast<double>(commands);
  }
  before_ = counts;
  measured_ = own_ticks_ + ns * 1e-9 / tick_;
  const double now = rounded(measured_);
  // By two steps, so that a mean at the edge of one does not count as another each time.
  const bool is_shorter = now <= counted_ - 2 * step;
  shorter_ = is_shorter ? shorter_ + 1 : 0;
  if (now <= counted_ && shorter_ < settled_windows) return false;
  shorter_ = 0;
  counted_ = now;
  return true;
}

}  // namespace spm::servo
