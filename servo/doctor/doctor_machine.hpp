// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "servo/doctor/machine_facts.hpp"
#include "servo/doctor/verdict.hpp"

namespace spm::servo {

/// Longest time to leave an idle state that still allows a good wake-up, us: a tenth of a tick.
inline constexpr double good_idle_exit_us = 100;

/// Good with PREEMPT_RT, fair without; how fair is shown by the wake-ups.
[[nodiscard]] Check judge_kernel(const MachineFacts& facts);
/// Fair on a virtual machine, whose host may stop it at any time.
[[nodiscard]] Check judge_virtual(const MachineFacts& facts);
/// Good if every processor's governor is `performance`; unknown if none can be read.
[[nodiscard]] Check judge_governor(const MachineFacts& facts);
/// Good if the slowest idle state in use is left within good_idle_exit_us, or `run` may hold it
/// off.
[[nodiscard]] Check judge_idle(const MachineFacts& facts);
/// Good if this user may hold /dev/cpu_dma_latency, as `run` does while its loop runs.
[[nodiscard]] Check judge_latency(const MachineFacts& facts);
/// Good if a core is left for the loop on which no USB controller interrupts.
[[nodiscard]] Check judge_interrupts(const MachineFacts& facts);
/// Good with two processors or more.
[[nodiscard]] Check judge_processors(const MachineFacts& facts);
/// Poor if real-time threads get no time at all (sched_rt_runtime_us is 0).
[[nodiscard]] Check judge_throttling(const MachineFacts& facts);
/// Fair if a control group limits the processor time; poor if it limits it to less than one
/// processor.
[[nodiscard]] Check judge_cgroup(const MachineFacts& facts);

}  // namespace spm::servo
