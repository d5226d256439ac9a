// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/error.hpp"

namespace spm::servo {

/// Asks RealtimeKit, over the system bus, to make the calling thread a real-time thread (SCHED_RR).
/// Desktops run RealtimeKit for users who have no limit of their own. `below_most`: how far below
/// the highest priority that it grants. Returns the priority.
///
/// RealtimeKit demands a limit that holds for all threads of the process and cannot be taken back:
/// a thread that computes for longer than the limit allows (0.2 s is usual) without a sleep ends
/// the process.
///
/// Blocks for some ms, and for seconds if the bus does not answer. Errors: realtime_refused, in
/// RealtimeKit's words. If it was not reached, the limit is left as it was.
[[nodiscard]] Result<int> ask_realtime_kit(int below_most);

}  // namespace spm::servo
