// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "servo/doctor/machine_facts.hpp"
#include "servo/doctor/verdict.hpp"

namespace spm::servo {

/// Longest time to leave an idle state that leaves a wake-up good, us: a tenth of a tick.
inline constexpr double good_idle_exit_us = 100;

/// Good with PREEMPT_RT, fair without: the wake-ups tell how fair.
[[nodiscard]] Check judge_kernel(const MachineFacts& facts);
/// Fair on a virtual machine, whose host may stop it at any time.
[[nodiscard]] Check judge_virtual(const MachineFacts& facts);
/// Good where every processor's governor is `performance`; unknown where none is to be seen.
[[nodiscard]] Check judge_governor(const MachineFacts& facts);
/// Good where the slowest idle state in use is left within good_idle_exit_us.
[[nodiscard]] Check judge_idle(const MachineFacts& facts);
/// Good with two processors or more.
[[nodiscard]] Check judge_processors(const MachineFacts& facts);
/// Poor where real-time threads get no time at all (sched_rt_runtime_us is 0).
[[nodiscard]] Check judge_throttling(const MachineFacts& facts);
/// Fair where a control group limits the processor time, poor where to less than one processor.
[[nodiscard]] Check judge_cgroup(const MachineFacts& facts);

}  // namespace spm::servo
