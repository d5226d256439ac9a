// SPDX-License-Identifier: Apache-2.0
#include "servo/realtime/stop_signals.hpp"

#include <array>
#include <csignal>

namespace spm::servo {

namespace {

constexpr std::array<int, 3> signals{SIGINT, SIGTERM, SIGHUP};

std::atomic<bool> stop_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free);

std::array<struct sigaction, signals.size()> previous_actions;

extern "C" void request_stop(int) { stop_requested.store(true); }

sigset_t stop_set() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : signals) sigaddset(&set, signal);
  return set;
}

}  // namespace

StopSignals::StopSignals() {
  stop_requested.store(false);
  const sigset_t set = stop_set();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  struct sigaction action {};
  action.sa_handler = request_stop;
  sigemptyset(&action.sa_mask);
  for (std::size_t i = 0; i < signals.size(); ++i) {
    sigaction(signals[i], &action, &previous_actions[i]);
    // A program that was started by nohup is meant to outlive its terminal.
    const bool outlive = signals[i] == SIGHUP && previous_actions[i].sa_handler == SIG_IGN;
    if (outlive) sigaction(signals[i], &previous_actions[i], nullptr);
  }
}

StopSignals::~StopSignals() {
  listen();
  for (std::size_t i = 0; i < signals.size(); ++i) {
    sigaction(signals[i], &previous_actions[i], nullptr);
  }
}

const std::atomic<bool>& StopSignals::flag() const noexcept { return stop_requested; }

void StopSignals::listen() {
  const sigset_t set = stop_set();
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

}  // namespace spm::servo
