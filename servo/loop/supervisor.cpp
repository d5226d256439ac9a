// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/supervisor.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/syscall.h>
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

/// Memory that this process and those that it starts share, by a descriptor.
using Beat = std::atomic<std::int64_t>;
static_assert(Beat::is_always_lock_free);
Beat* shared_beat(int& descriptor) noexcept {
  descriptor = memfd_create("spm-beat", MFD_CLOEXEC);
  if (descriptor < 0 || ftruncate(descriptor, sizeof(Beat)) != 0) return nullptr;
  Beat* const beat = map_beat(descriptor);
  return beat != nullptr ? new (beat) Beat(0) : nullptr;
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

std::atomic<std::int64_t>* map_beat(int descriptor) noexcept {
  void* const memory =
      mmap(nullptr, sizeof(Beat), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
  return memory == MAP_FAILED ? nullptr : static_cast<Beat*>(memory);
}

Result<std::unique_ptr<Supervisor>> Supervisor::start(const Open& open, RealtimeMode realtime,
                                                      const Afterwards& afterwards,
                                                      StartAgain again) {
  const StartAgain first = [&open, realtime, &afterwards](int end, int beat_memory) {
    const pid_t process = fork();
    if (process == 0) {
      // If the daemon was started without standard files, the descriptor may have one of their
      // numbers.
      const int line = fcntl(end, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
      const Beat* const beat = map_beat(beat_memory);
      if (beat == nullptr) _exit(static_cast<int>(ExitCode::file_or_device));
      be_the_supervisor(line, *beat, open, realtime, afterwards);
    }
    return process;
  };
  return start_by(first, std::move(again));
}

Result<std::unique_ptr<Supervisor>> Supervisor::start_by(const StartAgain& first,
                                                         StartAgain again) {
  std::unique_ptr<Supervisor> supervisor(new Supervisor(std::move(again)));
  supervisor->beat_ = shared_beat(supervisor->beat_memory_);
  if (supervisor->beat_ == nullptr) return not_started(errno);
  if (auto begun = supervisor->begin(first); !begun) return tl::make_unexpected(begun.error());
  return supervisor;
}

/// Called under the mutex, or while nobody else knows this. The other end of the connection is
/// closed here, so that it ends with the other process.
Result<void> Supervisor::begin(const StartAgain& start) {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return not_started(errno);
  }
  line_ = ends[0];
  process_ = start(ends[1], beat_memory_);
  const int error_number = errno;
  close(ends[1]);
  // The header of glibc 2.36 declares it for C alone.
  if (process_ > 0) end_ = static_cast<int>(syscall(SYS_pidfd_open, process_, 0));
  const bool is_begun = process_ >= 0 && is_ready(line_);
  // The connection of one elsewhere ends with it; nothing more comes by it before.
  if (process_ == 0) end_ = fcntl(line_, F_DUPFD_CLOEXEC, 0);
  if (is_begun && (targets_.empty() || say(line_, targets_))) return {};
  const int why = process_ >= 0 ? ECHILD : error_number;
  let_go_of_the_dead();
  return not_started(why);
}

/// One that has not ended yet does when its connection is closed.
void Supervisor::let_go_of_the_dead() noexcept {
  if (line_ >= 0) close(std::exchange(line_, -1));
  if (end_ >= 0) close(std::exchange(end_, -1));
  while (process_ > 0 && waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
}

bool Supervisor::await_end(int stop) const {
  int end = -1;
  {
    const std::lock_guard lock(mutex_);
    if (end_ >= 0) end = fcntl(end_, F_DUPFD_CLOEXEC, 0);
  }
  std::array<pollfd, 2> watched{{{stop, POLLIN, 0}, {end, POLLIN, 0}}};
  while (poll(watched.data(), watched.size(), -1) < 0 && errno == EINTR) {
  }
  if (end >= 0) close(end);
  return watched[0].revents == 0;
}

Result<void> Supervisor::replace() {
  const std::lock_guard lock(mutex_);
  // Another thread may have come first.
  pollfd ended{end_, POLLIN, 0};
  if (end_ >= 0 && poll(&ended, 1, 0) == 0) return {};
  let_go_of_the_dead();
  if (again_) return begin(again_);
  return fail(
      ExitCode::file_or_device,
      "the supervisor, which sends zero force where this program is killed, has ended: start "
      "again, or run with --supervisor off");
}

Result<void> Supervisor::watch(const std::vector<std::string>& targets) {
  // Never an empty message, which would be the end of the connection.
  std::string lines = "\n";
  for (const std::string& target : targets) {
    if (!target.empty()) lines += target + "\n";
  }
  {
    const std::lock_guard lock(mutex_);
    targets_ = lines;
    if (line_ >= 0 && say(line_, lines)) return {};
  }
  return replace();
}

void Supervisor::dismiss() noexcept {
  const std::lock_guard lock(mutex_);
  if (line_ >= 0) static_cast<void>(say(line_, good_bye));
  let_go_of_the_dead();
  if (beat_ != nullptr) munmap(std::exchange(beat_, nullptr), sizeof(Beat));
  if (beat_memory_ >= 0) close(std::exchange(beat_memory_, -1));
}

}  // namespace spm::servo
