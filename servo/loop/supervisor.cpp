// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/supervisor.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <new>
#include <string_view>
#include <utility>

#include "servo/loop/supervisor_process.hpp"

namespace spm::servo {

namespace {

/// The other process, which ends here.
[[noreturn]] void be_the_supervisor(int line, const std::atomic<std::int64_t>& beat,
                                    const OpenZeroForce& open, RealtimeMode realtime,
                                    const AfterTheEnd& afterwards) noexcept {
  supervise(line, beat, open, realtime, afterwards);
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

/// Sends a message. False if nobody listens.
bool say(int line, std::string_view text) noexcept {
  ssize_t size = 0;
  do {
    size = send(line, text.data(), text.size(), MSG_NOSIGNAL);
  } while (size < 0 && errno == EINTR);
  return size == static_cast<ssize_t>(text.size());
}

/// Memory that this process and those that it forks share.
using Beat = std::atomic<std::int64_t>;
static_assert(Beat::is_always_lock_free);
Beat* shared_beat() noexcept {
  void* const memory =
      mmap(nullptr, sizeof(Beat), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  return memory == MAP_FAILED ? nullptr : new (memory) Beat(0);
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

Result<std::unique_ptr<Supervisor>> Supervisor::start(const Open& open, RealtimeMode realtime,
                                                      const Afterwards& afterwards) {
  Beat* const beat = shared_beat();
  if (beat == nullptr) return not_started(errno);
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    const int error_number = errno;
    munmap(beat, sizeof *beat);
    return not_started(error_number);
  }
  const pid_t process = fork();
  if (process == 0) {
    close(ends[0]);
    // If the daemon was started without standard files, the descriptor may have one of their
    // numbers.
    const int line = fcntl(ends[1], F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    be_the_supervisor(line, *beat, open, realtime, afterwards);
  }
  const int error_number = errno;
  close(ends[1]);
  std::unique_ptr<Supervisor> supervisor(new Supervisor(ends[0], process, beat));
  if (process < 0) return not_started(error_number);
  if (!is_ready(ends[0])) return not_started(ECHILD);
  return supervisor;
}

Result<void> Supervisor::watch(const std::vector<std::string>& targets) {
  // Never an empty message, which would be the end of the connection.
  std::string lines = "\n";
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
  munmap(beat_, sizeof *beat_);
  while (process_ > 0 && waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

}  // namespace spm::servo
