// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/supervisor.hpp"

#include <fcntl.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <climits>
#include <csignal>
#include <cstring>
#include <optional>
#include <sstream>
#include <string_view>
#include <thread>
#include <utility>

namespace spm::servo {

namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// Different from the daemon's name, so that `killall spm-servo` ends the daemon alone. At most 15
/// characters.
constexpr const char* process_name = "spm-supervisor";

/// The last line from a daemon that ends as it should. A device has a line of its own.
constexpr std::string_view good_bye = "good-bye\n";

/// Sent to the daemon when the supervisor has let go of the daemon's files, so that it exists
/// before a device is open.
constexpr char ready = 'r';

constexpr milliseconds longest_search{2000};
constexpr int zeros_sent = 6;
// between two zero forces, and between two searches for a device
constexpr milliseconds interval{20};

/// A device after the daemon's death.
struct LeftDevice {
  std::string target;
  ZeroForce send;  ///< empty until the device is open
  int left = zeros_sent;
  std::string problem;  ///< why the device is not open
};

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
  sched_param parameters{};
  sched_setscheduler(0, SCHED_OTHER, &parameters);

  const auto kept = static_cast<unsigned>(line);
  if (kept > STDERR_FILENO + 1) close_range(STDERR_FILENO + 1, kept - 1, 0);
  close_range(kept + 1, UINT_MAX, 0);
  const int nothing = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  dup2(nothing, STDIN_FILENO);
  // A program that reads the daemon's output must not wait for this process.
  dup2(nothing, STDOUT_FILENO);
  close(nothing);
}

/// Waits for the daemon's end. Returns the devices that it left, or nothing if it said good-bye.
std::optional<std::vector<LeftDevice>> wait_for_end(int line) {
  std::string said;
  std::array<char, 512> part{};
  while (!said.ends_with(good_bye)) {
    const ssize_t size = read(line, part.data(), part.size());
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) break;
    said.append(part.data(), static_cast<std::size_t>(size));
  }
  if (said.ends_with(good_bye)) return std::nullopt;
  std::vector<LeftDevice> devices;
  std::istringstream lines(said);
  for (std::string target; std::getline(lines, target);)
    devices.push_back({target, {}, zeros_sent, {}});
  return devices;
}

/// Sends zero once to a device, which is opened first if it is not open. Returns whether more is to
/// be done.
bool serve(LeftDevice& device, const Supervisor::Open& open, steady_clock::time_point due) {
  if (device.left == 0) return false;
  if (!device.send) {
    if (steady_clock::now() >= due) return false;
    auto opened = open(device.target);
    if (!opened) {
      device.problem = std::move(opened.error().message);
      return true;
    }
    device.send = std::move(*opened);
  }
  if (device.send()) {
    --device.left;
  } else {
    device.send = nullptr;
    device.left = zeros_sent;
    device.problem = "it was lost while zero was sent";
  }
  return device.left > 0;
}

void send_zero_to(std::vector<LeftDevice>& devices, const Supervisor::Open& open) {
  const auto due = steady_clock::now() + longest_search;
  while (true) {
    bool any_left = false;
    // All are held open until the last one is done, so that none is found twice.
    for (LeftDevice& device : devices) any_left = serve(device, open, due) || any_left;
    if (!any_left) return;
    std::this_thread::sleep_for(interval);
  }
}

std::string sentence_of(const std::vector<LeftDevice>& devices) {
  std::string sent, failed;
  for (const LeftDevice& device : devices) {
    if (device.left == 0) {
      sent += (sent.empty() ? "" : " and ") + device.target;
    } else {
      failed += (failed.empty() ? "" : " and ") + device.target + " (" + device.problem + ")";
    }
  }
  std::string sentence = "error: spm-servo ended without a good-bye, killed or crashed: ";
  if (!sent.empty()) sentence += "zero force was sent to " + sent;
  if (!sent.empty() && !failed.empty()) sentence += ", but ";
  if (!failed.empty()) {
    sentence += "no zero force could be sent to " + failed + ": let go of it and switch it off";
  }
  return sentence + "\n";
}

/// Everything that the other process does.
void supervise(int line, const Supervisor::Open& open) noexcept {
  let_go_of_the_daemon(line);
  static_cast<void>(!write(line, &ready, 1));
  auto devices = wait_for_end(line);
  if (!devices || devices->empty()) return;
  send_zero_to(*devices, open);
  const std::string sentence = sentence_of(*devices);
  static_cast<void>(!write(STDERR_FILENO, sentence.data(), sentence.size()));
}

/// The other process, which ends here.
[[noreturn]] void be_the_supervisor(int line, const Supervisor::Open& open) noexcept {
  supervise(line, open);
  // Not exit(): what the daemon registered for its end does not concern this process.
  _exit(static_cast<int>(ExitCode::done));
}

/// Waits until the other process is ready. False if it ended before that.
bool is_ready(int line) noexcept {
  char told = 0;
  ssize_t size = 0;
  do {
    size = read(line, &told, 1);
  } while (size < 0 && errno == EINTR);
  return size == 1;
}

/// False if nobody listens.
bool say(int line, std::string_view text) noexcept {
  while (!text.empty()) {
    const ssize_t size = send(line, text.data(), text.size(), MSG_NOSIGNAL);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(size));
  }
  return true;
}

tl::unexpected<Error> not_started(int error_number) {
  return fail(
      ExitCode::file_or_device,
      std::string("the supervisor, which sends zero force where this program is killed, "
                  "cannot be started (") +
          std::strerror(error_number) +
          "): raise the limits of processes and of open files, or run with --supervisor off");
}

}  // namespace

Result<std::unique_ptr<Supervisor>> Supervisor::start(Open open) {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return not_started(errno);
  }
  const pid_t process = fork();
  if (process == 0) {
    close(ends[0]);
    // If the daemon was started without standard files, the descriptor may have one of their
    // numbers.
    const int line = fcntl(ends[1], F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    be_the_supervisor(line, open);
  }
  const int error_number = errno;
  close(ends[1]);
  if (process < 0) {
    close(ends[0]);
    return not_started(error_number);
  }
  std::unique_ptr<Supervisor> supervisor(new Supervisor(ends[0], process));
  if (!is_ready(ends[0])) return not_started(ECHILD);
  return supervisor;
}

Result<void> Supervisor::watch(const std::vector<std::string>& targets) {
  std::string lines;
  for (const std::string& target : targets) {
    if (!target.empty()) lines += target + "\n";
  }
  if (line_ >= 0 && say(line_, lines)) return {};
  return fail(
      ExitCode::file_or_device,
      "the supervisor, which sends zero force where this program is killed, has ended: start "
      "again, or run with --supervisor off");
}

void Supervisor::dismiss() noexcept {
  if (line_ < 0) return;
  static_cast<void>(say(line_, good_bye));
  close(std::exchange(line_, -1));
  while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

}  // namespace spm::servo
