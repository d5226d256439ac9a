// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/supervisor_watch.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cstdint>
#include <utility>

#include "servo/base/clock.hpp"
#include "servo/realtime/realtime.hpp"

namespace spm::servo {

namespace {

/// Between two starts, so that one that ends at once does not take the machine's time.
constexpr int pause_ms = 1000;

}  // namespace

SupervisorWatch::SupervisorWatch(Supervisor* supervisor, Log warn) : warn_(std::move(warn)) {
  if (supervisor == nullptr) return;
  stop_ = eventfd(0, EFD_CLOEXEC);
  if (stop_ < 0) {
    warn_("the supervisor is not watched: raise the limit of open files");
    return;
  }
  thread_ = std::thread([this, supervisor] { look(*supervisor); });
}

SupervisorWatch::~SupervisorWatch() {
  if (!thread_.joinable()) return;
  const std::uint64_t one = 1;
  static_cast<void>(!write(stop_, &one, sizeof one));
  thread_.join();
  close(stop_);
}

void SupervisorWatch::look(Supervisor& supervisor) const {
  leave_realtime();
  std::int64_t begun_ns = 0;
  const auto told_to_end = [this](int milliseconds) {
    pollfd stop{stop_, POLLIN, 0};
    return poll(&stop, 1, milliseconds) > 0;
  };
  bool failed = false;
  while (failed ? !told_to_end(pause_ms) : supervisor.await_end(stop_)) {
    if (now_ns() - begun_ns < std::int64_t{pause_ms} * 1'000'000 && told_to_end(pause_ms)) return;
    begun_ns = now_ns();
    const auto replaced = supervisor.replace();
    if (replaced) {
      warn_(
          "the supervisor, which sends zero force where this program is killed, had ended, killed "
          "or crashed: it was started again");
    } else if (!failed) {
      warn_(replaced.error().message + "; it had ended, killed or crashed, and is tried again");
    }
    failed = !replaced;
  }
}

}  // namespace spm::servo
