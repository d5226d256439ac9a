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

/// A process beside the daemon that sends the daemon's devices zero force if the daemon ends
/// without saying good-bye, killed or crashed. It then opens the devices itself, for 2 s at most,
/// sends zero several times over 0.1 s, reports in one sentence on the standard error what it did,
/// and ends.
///
/// It holds none of the daemon's files except the standard error and its end of a connection
/// between the two. It is in no group that a signal to the daemon's group would reach, ignores the
/// signals that end other processes, and has no real-time priority. If the machine writes a core
/// file of the daemon, the devices are free only after that.
class Supervisor {
 public:
  using Open = std::function<Result<ZeroForce>(const std::string& target)>;

  /// Starts it. The calling process must have no threads yet, and no device open, because the
  /// forked process would inherit them. `open` runs in the other process. Errors: file_or_device,
  /// if no process or connection can be made.
  [[nodiscard]] static Result<std::unique_ptr<Supervisor>> start(Open open = open_zero_force);

  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;
  ~Supervisor() { dismiss(); }

  /// Names devices to look after, in the form of zero_force_target. Empty names are left out. Call
  /// it before the first force is sent to them. Errors: file_or_device, if the supervisor has
  /// ended.
  [[nodiscard]] Result<void> watch(const std::vector<std::string>& targets);

  /// Says good-bye, after the devices were closed. The supervisor ends and sends nothing. Waits for
  /// its end.
  void dismiss() noexcept;

 private:
  Supervisor(int line, pid_t process) noexcept : line_(line), process_(process) {}

  int line_;  ///< a socket, because writing to a pipe that nobody reads would end the daemon
  pid_t process_;
};

}  // namespace spm::servo
