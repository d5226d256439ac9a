// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "common/base/error.hpp"
#include "servo/devices/base/device.hpp"

namespace spm::servo {

/// Sends a device zero force once. Soon after another one it takes the device's answer first, which
/// may last port_wait. False if the device is lost.
using ZeroForce = std::function<bool()>;

/// The target for open_zero_force that means an open device: its driver, and where it is plugged
/// in. Empty if the device's force ends without that. For each device:
/// - falcon: needs it. How long its firmware keeps a force when it receives nothing is not known
///   [U]; users report that it stops after a while.
/// - woodenhaptics: needs it. According to their public firmware V1 and V2 boards have a watchdog
/// of
///   0.5 s, so that zero force comes sooner; of V3 boards none is known. None was tried on a device
///   here [U].
/// - pid: its effects end by themselves after pid_effect_seconds [U], except with `watchdog=off`.
///   Opening the device resets it.
/// - external: needs none. The other process applies zero once the daemon was silent for
///   SPM_EXTERNAL_SILENCE_NS.
/// - spacemouse, sim: give no force.
[[nodiscard]] std::string zero_force_target(const Device& device);

/// Whether a device may be opened by open_zero_force while the daemon drives it: nothing is sent to
/// it then, and nothing taken from the daemon.
[[nodiscard]] bool may_open_early(const std::string& target);

/// Opens a device by its port alone, without the loop and its threads, for a process that outlives
/// the daemon, or finds it standing still. A Falcon's chip is only claimed, neither reset nor set
/// up: since a daemon drove it, firmware runs and its line is set. It is taken from a daemon that
/// still holds it, which loses the device by that. Errors: file_or_device, for not found, no
/// permission, in use; usage, for an invalid target.
[[nodiscard]] Result<ZeroForce> open_zero_force(const std::string& target);

}  // namespace spm::servo
