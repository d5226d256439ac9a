// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/build/time_limit.hpp"

#include <chrono>
#include <cstdlib>
#include <utility>

#include "common/base/error.hpp"
#include "formats/cli/command_line.hpp"

namespace spm::baker {

TimeLimit::TimeLimit(std::uint64_t seconds, std::string what)
    : watch_([this, seconds, what = std::move(what)] {
        std::unique_lock lock(mutex_);
        const auto limit = std::chrono::seconds(static_cast<std::int64_t>(seconds));
        if (changed_.wait_for(lock, limit, [this] { return disarmed_; })) return;
        // The other threads are still at work: no destructor may run.
        std::_Exit(
            cli::report({ExitCode::tolerance_not_met,
                         what + ": not written: the time limit of " + std::to_string(seconds) +
                             " s is reached; ask for a larger --time-limit or "
                             "--tolerance, or simplify the mesh"}));
      }) {}

TimeLimit::~TimeLimit() {
  disarm();
  watch_.join();
}

void TimeLimit::disarm() {
  const std::lock_guard lock(mutex_);
  disarmed_ = true;
  changed_.notify_all();
}

}  // namespace spm::baker
