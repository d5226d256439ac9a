// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "servo/devices/finder/zero_force.hpp"

namespace spm::servo {

/// A process beside the daemon that sends its devices zero force where the daemon ends without
/// saying good-bye: killed, or crashed. It then opens them itself, for 2 s at most, sends zero some
/// times over 0.1 s, says in one sentence on the standard error what it did, and ends. It holds
/// none of the daemon's files but the standard error and its end of a line between the two, is in
/// no group that a signal to the daemon's would reach, ignores what ends others, and has no
/// real-time priority. Where the machine writes a core file of the daemon, the devices are free
/// only after it.
class Supervisor {
 public:
  using Open = std::function<Result<ZeroForce>(const std::string& target)>;

  /// Starts it. By a process that has no threads yet, and no device open: what it forks has
  /// neither. `open` runs in the other process. Errors: file_or_device, no process or line is to be
  /// had.
  [[nodiscard]] static Result<std::unique_ptr<Supervisor>> start(Open open = open_zero_force);

  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;
  ~Supervisor() { dismiss(); }

  /// Names devices to look after, as zero_force_target does; empty ones are left out. Before the
  /// first force is sent to them. Errors: file_or_device, the supervisor has ended.
  [[nodiscard]] Result<void> watch(const std::vector<std::string>& targets);

  /// Says good-bye, after the devices were closed: it ends, and sends nothing. Waits for that.
  void dismiss() noexcept;

 private:
  Supervisor(int line, pid_t process) noexcept : line_(line), process_(process) {}

  int line_;  ///< a socket, as writing to a pipe that nobody reads would end the daemon
  pid_t process_;
};

}  // namespace spm::servo
