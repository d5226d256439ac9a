// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "servo/loop/left_devices.hpp"
#include "servo/realtime/realtime.hpp"

namespace spm::servo {

/// The last message from a daemon that ends as it should. Others are lists of devices, a line each.
inline constexpr std::string_view good_bye = "good-bye\n";

/// What else to do after the daemon's death; returns a line for the standard error, or nothing.
/// It may read memory that is shared with the daemon.
using AfterTheEnd = std::function<std::string()>;

/// The memory of the beat, by its descriptor; null where it cannot be had.
[[nodiscard]] std::atomic<std::int64_t>* map_beat(int descriptor) noexcept;

/// What the other process of a Supervisor does. `line`: its end of the connection, a socket that
/// keeps messages apart. `beat`: shared with the daemon, when its last tick began; 0: it does not
/// tick. Returns when the daemon said good-bye, or when it has ended and its devices were served.
void supervise(int line, const std::atomic<std::int64_t>& beat, const OpenZeroForce& open,
               RealtimeMode realtime, const AfterTheEnd& afterwards) noexcept;

}  // namespace spm::servo
