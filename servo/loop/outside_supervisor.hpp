// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "servo/loop/supervisor.hpp"
#include "servo/record/black_box_memory.hpp"

namespace spm::servo {

/// Whether a supervisor may be asked for at a socket. Errors: file_or_device, where nobody listens
/// there, or one of another user who is not root.
[[nodiscard]] Result<void> check_outside_supervisor(const std::string& path);

/// How this program starts a supervisor that is no process of its own: it asks for one at the
/// socket `path`, where serve_supervisors listens, outside of the container or group that this
/// process may be paused with. It hands on its end of the connection, the memory of the beat and,
/// where `memory` is not null, that of the black box. Returns 0: no child.
[[nodiscard]] Supervisor::StartAgain start_outside(const std::string& path,
                                                   const BlackBoxMemory* memory);

/// What serve_supervisors needs to know.
struct OutsideSupervisors {
  std::string path;  ///< of the socket
  RealtimeMode realtime = RealtimeMode::attempt;
  std::string black_box;  ///< as write_black_box takes it; empty: none is kept
  OpenZeroForce open = open_zero_force;
  /// What a person should read: a daemon has a supervisor, or gets none.
  std::function<void(const std::string&)> tell, warn;
};

/// Listens until `stop`, and makes a supervisor for each daemon that asks: a process that outlives
/// this one, until its daemon's end. The calling process must have no threads. Daemons of this user
/// and of root may ask. Errors: as ListeningSocket::open.
[[nodiscard]] Result<void> serve_supervisors(const OutsideSupervisors& settings,
                                             const std::atomic<bool>& stop);

}  // namespace spm::servo
