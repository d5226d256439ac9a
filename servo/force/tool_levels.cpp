// SPDX-License-Identifier: Apache-2.0
#include "servo/force/tool_levels.hpp"

#include <algorithm>

namespace spm {

namespace {

/// Samples that a tick must have looked at before it ran out of time, for the next to be coarser.
constexpr std::uint32_t telling_work = 512;
/// Looks of the virtual tool that a tick must have time for: fewer follow no hand, however fine
/// they are. Where more did not lead to its balance, coarser ones would not either.
constexpr std::uint32_t least_looks = 4;

}  // namespace

void ToolLevels::note(const ToolEffort& effort, std::uint32_t last) noexcept {
  const bool goes_on = unresolved_ > 0 ? effort.unresolved < unresolved_ : effort.unresolved > 1;
  unresolved_ = effort.unresolved;
  const bool again = alarm_ > 0;
  if (again) --alarm_;
  const bool settles = settling_ > 0;
  if (settles) --settling_;
  const bool steps_late = effort.steps_late && effort.looks < least_looks;
  if (!effort.looks_late && !steps_late) {
    if (patience_ > 0 && --patience_ == 0) try_finer(last);
    return;
  }
  // The next one begins where it was over.
  if (effort.looks_late && goes_on) {
    if (finest_ == every) alarm_ = patience_ = 0;
    return;
  }
  // A tick that had hardly any time, since it began late, says nothing of the next one; nor does
  // one that has just been given a finer level, whose samples are all to be found first.
  if (effort.worked < telling_work || settles) return;
  // One alone may have been interrupted. Two say little: a level at a time.
  alarm_ = waiting_ticks;
  patience_ = std::max(patience_, wait_);
  if (again) use_coarser(effort.looks_late ? effort.level : 0, last);
}

/// The next ticks look at a level less, but at `level`.
void ToolLevels::use_coarser(std::uint32_t level, std::uint32_t last) noexcept {
  const std::uint32_t before = std::min(finest_, last);
  finest_ = std::max(level, before > 0 ? before - 1 : 0);
  // The finer one was tried in vain.
  if (tried_) wait_ = std::min(2 * wait_, longest_wait);
  tried_ = false;
  patience_ = wait_;
  // What it comes to there is told by two ticks more.
  alarm_ = 0;
}

/// Time has sufficed for a while.
void ToolLevels::try_finer(std::uint32_t last) noexcept {
  if (finest_ == every) {
    wait_ = waiting_ticks;
    tried_ = false;
    return;
  }
  tried_ = true;
  patience_ = wait_;
  settling_ = settling_ticks;
  ++finest_;
  if (finest_ >= last) finest_ = every;
}

}  // namespace spm
