// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "common/base/error.hpp"
#include "servo/devices/base/device.hpp"

namespace spm::servo {

/// Sends a device zero force once, and takes what it answers, which may last port_wait; false where
/// it is lost.
using ZeroForce = std::function<bool()>;

/// What to tell open_zero_force of an open device: its driver, and where it is plugged in. Empty
/// where its force ends without that. By devices:
/// - falcon: needs it. How long its firmware keeps a force when it hears nothing is not known [U];
///   users report that it stops after a while.
/// - woodenhaptics: V1 and V2 boards have a watchdog of 0.5 s, says their public firmware, so that
///   zero force comes sooner; of V3 boards none is known. None was tried on a device here [U].
/// - pid: its effects end by themselves after pid_effect_seconds [U], unless watchdog=off; to open
///   it is to reset it.
/// - external: needs none; the other process applies zero once the daemon was silent for
///   SPM_EXTERNAL_SILENCE_NS.
/// - pid: ends by itself after 0.2 s, except with `watchdog=off`.
/// - spacemouse, sim: give no force.
[[nodiscard]] std::string zero_force_target(const Device& device);

/// Opens a device by its port alone, without the loop and threads: for a process that outlives the
/// daemon. A Falcon's chip is only claimed, neither reset nor set up: firmware runs, and its line
/// is set, since a daemon drove it. Errors: file_or_device, not found, no permission, in use;
/// usage, a target that is none.
[[nodiscard]] Result<ZeroForce> open_zero_force(const std::string& target);

}  // namespace spm::servo
