// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "servo/loop/left_devices.hpp"
#include "servo/loop/supervisor_process.hpp"
#include "servo/realtime/realtime.hpp"

namespace spm::servo {

/// A process beside the daemon that sends the daemon's devices zero force in two cases. Where the
/// daemon ends without saying good-bye, killed or crashed, it opens the devices itself, for 2 s at
/// most, sends zero several times over 0.1 s, reports in one sentence on the standard error what it
/// did, and ends. Where no tick of the daemon's loop began for loop_stall_ns, stopped by a signal,
/// a debugger or a freezer, or kept from its processor, it does the same, but stays, and leaves the
/// devices to the loop when that ticks again.
///
/// It holds none of the daemon's files except the standard error and its end of a connection
/// between the two. It is in no group that a signal to the daemon's group would reach, ignores the
/// signals that end other processes, and has a real-time priority above the loop's, if that is
/// allowed: it sleeps nearly always. If the machine writes a core
/// file of the daemon, the devices are free only after that.
class Supervisor {
 public:
  using Open = OpenZeroForce;

  using Afterwards = AfterTheEnd;

  /// Starts the other process again where this one has threads by then, so that it may not just
  /// fork: with its end of the connection, and the memory of the beat. Returns its number; 0 for
  /// one that is no child of this process; or -1 and an error number.
  using StartAgain = std::function<pid_t(int line, int beat)>;

  /// Starts it. The calling process must have no threads yet, and no device open, because the
  /// forked process would inherit them. `open` and `afterwards` run in the other process, the
  /// latter when the devices are free; `realtime` is for that process too. Errors: file_or_device,
  /// if no process or connection can be made.
  [[nodiscard]] static Result<std::unique_ptr<Supervisor>> start(
      const Open& open = open_zero_force, RealtimeMode realtime = RealtimeMode::off,
      const Afterwards& afterwards = {}, StartAgain again = {});

  /// The same with a process that `first` makes now, and `again` later: one elsewhere
  /// (start_outside).
  [[nodiscard]] static Result<std::unique_ptr<Supervisor>> start_by(const StartAgain& first,
                                                                    StartAgain again);

  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;
  ~Supervisor() { dismiss(); }

  /// Names the devices to look after from now on, in the form of zero_force_target. Empty names are
  /// left out. Call it before the first force is sent to them, and when one is found at another
  /// place. If the supervisor has ended, it is started again. Errors: file_or_device, if that
  /// fails. Any thread may call this, and the next two.
  [[nodiscard]] Result<void> watch(const std::vector<std::string>& targets);

  /// Waits until the other process has ended, or `stop`, a descriptor, can be read; true for the
  /// first.
  [[nodiscard]] bool await_end(int stop) const;
  /// After its end: starts it again, and names the devices to it. Errors: file_or_device.
  [[nodiscard]] Result<void> replace();

  /// Where the loop leaves the time that each tick began, and 0 when it ends (LoopSettings::beat).
  [[nodiscard]] std::atomic<std::int64_t>& beat() noexcept { return *beat_; }

  /// Says good-bye, after the devices were closed. The supervisor ends and sends nothing. Waits for
  /// its end.
  void dismiss() noexcept;

 private:
  explicit Supervisor(StartAgain again) noexcept : again_(std::move(again)) {}
  [[nodiscard]] Result<void> begin(const StartAgain& start);
  void let_go_of_the_dead() noexcept;

  StartAgain again_;
  mutable std::mutex mutex_;  ///< guards the members below
  std::string targets_;       ///< the last message
  int line_ = -1;  ///< a socket, because writing to a pipe that nobody reads would end the daemon
  pid_t process_ = -1;
  int end_ = -1;  ///< a descriptor of the process, which can be read once that has ended
  int beat_memory_ = -1;
  std::atomic<std::int64_t>* beat_ = nullptr;
};

}  // namespace spm::servo
