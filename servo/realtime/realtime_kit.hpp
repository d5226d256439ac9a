// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/error.hpp"

namespace spm::servo {

/// Asks RealtimeKit, over the system bus, to make the calling thread a real-time one (SCHED_RR):
/// what desktops run for users who have no such limit. `below_most`: how far below the highest
/// priority that it gives. Gives the priority. It asks for a limit, for all threads of the process
/// and for good: one that computes for longer than it allows (0.2 s is usual) without a sleep ends
/// the process. Blocks for some ms, and for seconds where the bus does not answer. Errors:
/// realtime_refused, in its words, with the limit left as it was where it was not reached.
[[nodiscard]] Result<int> ask_realtime_kit(int below_most);

}  // namespace spm::servo
