// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/supervisor_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <climits>
#include <csignal>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "servo/base/clock.hpp"
#include "servo/devices/base/port.hpp"
#include "servo/realtime/own_scope.hpp"

namespace spm::servo {

namespace {

using std::chrono::milliseconds;
using Clock = LeftDevices::Clock;

/// Different from the daemon's name, so that `killall spm-servo` ends the daemon alone. At most 15
/// characters.
constexpr const char* process_name = "spm-supervisor";

/// Sent to the daemon when the supervisor has let go of the daemon's files, so that it exists
/// before a device is open.
constexpr char ready = 'r';

constexpr milliseconds longest_search{2000};
// between two zero forces, and between two searches for a device
constexpr milliseconds interval{20};
/// Between two looks at a loop that stands still: it waits for its devices when it goes on.
constexpr milliseconds look_again{2};
/// The daemon's loop was away for so long that a person should know.
constexpr milliseconds worth_a_word{500};
/// Longer than any list of devices.
constexpr std::size_t longest_message = std::size_t{64} * 1024;

/// Keeps nothing that belongs to the daemon, except `line` and the standard error.
void let_go_of_the_daemon(int line) {
  // A session of its own, so that signals to the daemon's group, or from its terminal, do not come
  // here.
  setsid();
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE}) {
    std::signal(number, SIG_IGN);
  }
  prctl(PR_SET_NAME, process_name);
  // If the daemon was started with a real-time priority, this process has inherited it. Locked
  // memory is not inherited.
  leave_realtime();

  const auto kept = static_cast<unsigned>(line);
  if (kept > STDERR_FILENO + 1) close_range(STDERR_FILENO + 1, kept - 1, 0);
  close_range(kept + 1, UINT_MAX, 0);
  const int nothing = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  dup2(nothing, STDIN_FILENO);
  // A program that reads the daemon's output must not wait for this process.
  dup2(nothing, STDOUT_FILENO);
  close(nothing);
}

void say(const std::string& sentence) {
  static_cast<void>(!write(STDERR_FILENO, sentence.data(), sentence.size()));
}

/// What came from the daemon.
enum class Heard : std::uint8_t { nothing, message, end };

/// Waits for a message until a time of now_ns(); 0: for ever.
Heard hear(int line, std::int64_t until_ns, std::string& message) {
  timespec left{};
  if (until_ns > 0) {
    const std::int64_t ns = std::max<std::int64_t>(0, until_ns - now_ns());
    left = {ns / 1'000'000'000, ns % 1'000'000'000};
  }
  pollfd watched{line, POLLIN, 0};
  const int count = ppoll(&watched, 1, until_ns > 0 ? &left : nullptr, nullptr);
  if (count <= 0) return Heard::nothing;
  message.resize(longest_message);
  const ssize_t size = recv(line, message.data(), message.size(), MSG_DONTWAIT);
  if (size < 0 && (errno == EINTR || errno == EAGAIN)) return Heard::nothing;
  if (size <= 0) return Heard::end;
  message.resize(static_cast<std::size_t>(size));
  return Heard::message;
}

std::vector<std::string> lines_of(const std::string& message) {
  std::vector<std::string> list;
  std::istringstream lines(message);
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty()) list.push_back(line);
  }
  return list;
}

/// Looks after the devices until the daemon's end.
class Watch {
 public:
  Watch(int line, const std::atomic<std::int64_t>& beat, const OpenZeroForce& open)
      : line_(line), beat_(beat), devices_(open) {}

  /// True if the daemon said good-bye.
  [[nodiscard]] bool run() {
    std::string message;
    while (true) {
      const Heard heard = hear(line_, next_ns_, message);
      if (heard == Heard::end) return false;
      if (heard == Heard::message) {
        if (message == good_bye) return true;
        devices_.watch(lines_of(message));
        stalled_at_ = 0;  // if the loop stands still, these have had no zero yet
      }
      look();
    }
  }

  void serve_all() {
    devices_.begin(Clock::now() + longest_search);
    while (devices_.send_zeros()) std::this_thread::sleep_for(interval);
  }

  [[nodiscard]] const LeftDevices& devices() const { return devices_; }

 private:
  /// Sends zero where the daemon's loop stands still, and says when to look again.
  void look() {
    const std::int64_t beat = beat_.load(std::memory_order_relaxed);
    const std::int64_t now = now_ns();
    if (devices_.empty()) {
      next_ns_ = 0;
    } else if (beat == 0 || now - beat < loop_stall_ns) {
      go_on();
      // A loop that does not tick yet is looked at now and then.
      next_ns_ = (beat == 0 ? now : beat) + loop_stall_ns;
    } else {
      if (stalled_at_ != beat || now >= zeros_due_ns_) {
        take_over(beat, now);
        zeros_due_ns_ = now + std::chrono::nanoseconds(interval).count();
      }
      next_ns_ = now_ns() + std::chrono::nanoseconds(look_again).count();
    }
  }

  void take_over(std::int64_t beat, std::int64_t now) {
    if (stalled_at_ != beat) {
      stalled_at_ = beat;
      said_ = false;
      devices_.begin(Clock::now() + longest_search);
    }
    const bool more = devices_.send_zeros();
    if (said_ || more || now - beat < std::chrono::nanoseconds(worth_a_word).count()) return;
    said_ = true;
    say("warning: spm-servo's loop stands still, stopped or kept from its processor: " +
        devices_.outcome() + "; it has its force back when it goes on\n");
  }

  void go_on() {
    if (stalled_at_ == 0) return;
    stalled_at_ = 0;
    devices_.let_go();
  }

  int line_;
  const std::atomic<std::int64_t>& beat_;
  LeftDevices devices_;
  std::int64_t next_ns_ = 0;       ///< when to look at the beat; 0: there is no need
  std::int64_t zeros_due_ns_ = 0;  ///< of a loop that stands still
  std::int64_t stalled_at_ = 0;    ///< the last beat of a loop that stands still; 0: it ticks
  bool said_ = false;
};

}  // namespace

void supervise(int line, const std::atomic<std::int64_t>& beat, const OpenZeroForce& open,
               RealtimeMode realtime, const AfterTheEnd& afterwards) noexcept {
  let_go_of_the_daemon(line);
  static_cast<void>(!write(line, &ready, 1));
  if (is_service()) static_cast<void>(enter_own_scope(process_name));
  enter_guard_thread(realtime);
  // Memory on disk would come back too late.
  if (realtime != RealtimeMode::off) static_cast<void>(mlockall(MCL_CURRENT));
  Watch watch(line, beat, open);
  if (watch.run()) return;
  if (!watch.devices().empty()) {
    watch.serve_all();
    say("error: spm-servo ended without a good-bye, killed or crashed: " +
        watch.devices().outcome() + "\n");
  }
  const std::string told = afterwards ? afterwards() : "";
  if (!told.empty()) say(told + "\n");
}

}  // namespace spm::servo
