// SPDX-License-Identifier: Apache-2.0
#include "servo/realtime/core_pinning.hpp"

#include <string>
#include <utility>

namespace spm::servo {

namespace {

/// The allowed cores as text, such as "0, 1 and 3".
std::string listed(const cpu_set_t& cores) {
  std::string text;
  for (unsigned core = 0; core < CPU_SETSIZE; ++core) {
    if (!CPU_ISSET(core, &cores)) continue;
    if (!text.empty()) text += ", ";
    text += std::to_string(core);
  }
  return text;
}

}  // namespace

Result<CorePinning> CorePinning::hold(std::optional<unsigned> core) {
  CorePinning pinning;
  if (!core) return pinning;
  cpu_set_t before;
  if (sched_getaffinity(0, sizeof before, &before) != 0) {
    return fail(ExitCode::usage,
                "--core: this system does not tell its cores; leave the option away");
  }
  cpu_set_t wanted;
  CPU_ZERO(&wanted);
  if (*core < CPU_SETSIZE) CPU_SET(*core, &wanted);
  if (*core >= CPU_SETSIZE || !CPU_ISSET(*core, &before) ||
      sched_setaffinity(0, sizeof wanted, &wanted) != 0) {
    return fail(ExitCode::usage, "--core " + std::to_string(*core) +
                                     " is no core that this program may use; it may use " +
                                     listed(before));
  }
  pinning.before_ = before;
  return pinning;
}

CorePinning::CorePinning(CorePinning&& other) noexcept
    : before_(std::exchange(other.before_, std::nullopt)) {}

CorePinning::~CorePinning() {
  if (before_) sched_setaffinity(0, sizeof *before_, &*before_);
}

}  // namespace spm::servo
