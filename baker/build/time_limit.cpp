// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/build/time_limit.hpp"

#include <array>
#include <chrono>
#include <cstdlib>
#include <utility>

#include "common/base/error.hpp"
#include "formats/cli/command_line.hpp"

namespace spm::baker {

namespace {

/// What of a mesh makes a stage long.
constexpr std::array<std::array<const char*, 2>, 6> hard{{
    {"load", "holes of many edges and triangles without neighbours"},
    {"surface", "triangles that cross each other, or face each other across narrow gaps"},
    {"casting", "much surface beside the tolerance"},
    {"lattice", "many triangles that are lower than rounding"},
    {"octree", "many triangles within the band of one place, and surfaces that nearly touch"},
    {"verify", "places that many triangles are equally near to"},
}};

}  // namespace

TimeLimit::TimeLimit(std::uint64_t seconds, std::string what)
    : watch_([this, seconds, what = std::move(what)] {
        std::unique_lock lock(mutex_);
        const auto limit = std::chrono::seconds(static_cast<std::int64_t>(seconds));
        if (changed_.wait_for(lock, limit, [this] { return disarmed_; })) return;
        // The other threads are still at work: no destructor may run.
        std::_Exit(cli::report(
            {ExitCode::tolerance_not_met, what + ": not written: the time limit of " +
                                              std::to_string(seconds) + " s is reached" + place() +
                                              "; ask for a larger --time-limit or "
                                              "--tolerance, or simplify the mesh"}));
      }) {}

TimeLimit::~TimeLimit() {
  disarm();
  watch_.join();
}

void TimeLimit::enter(std::string stage) {
  const std::lock_guard lock(mutex_);
  stage_ = std::move(stage);
}

void TimeLimit::describe(std::string mesh) {
  const std::lock_guard lock(mutex_);
  mesh_ = std::move(mesh);
}

std::string TimeLimit::place() const {
  if (stage_.empty()) return {};
  std::string text = " in the stage " + stage_;
  for (const auto& [stage, what] : hard) {
    if (stage_ == stage) text += std::string(", which is long for ") + what;
  }
  return mesh_.empty() ? text : text + " (the mesh has " + mesh_ + ")";
}

void TimeLimit::disarm() {
  const std::lock_guard lock(mutex_);
  disarmed_ = true;
  changed_.notify_all();
}

}  // namespace spm::baker
