// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/outside_supervisor.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>

#include "servo/app/listening_socket.hpp"
#include "servo/loop/supervisor_process.hpp"
#include "servo/loop/supervisor_program.hpp"
#include "servo/shared/passed_descriptors.hpp"

namespace spm::servo {

namespace {

/// What a daemon asks with; the descriptors come beside it: its line, the beat's memory, and the
/// black box's, if that has bytes.
struct Request {
  std::uint32_t magic = 0x53504d47;  // "SPMG"
  std::uint32_t version = 1;
  std::uint64_t box_half_bytes = 0;
};
/// How long a daemon may take to ask, and this process to look at `stop`, ms.
constexpr int ask_ms = 1000, look_ms = 200;

/// Whether the other end belongs to this user, or to root.
bool is_trusted(int connection) noexcept {
  ucred peer{};
  socklen_t size = sizeof peer;
  return getsockopt(connection, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 &&
         (peer.uid == geteuid() || peer.uid == 0);
}

/// Connects to a socket; -1 and an error number where nobody may be trusted there.
Descriptor connect_to(const std::string& path) noexcept {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) {
    errno = ENAMETOOLONG;
    return Descriptor();
  }
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  Descriptor made(socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0));
  if (made.get() < 0 ||
      connect(made.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    return Descriptor();
  }
  if (!is_trusted(made.get())) {
    errno = EPERM;
    return Descriptor();
  }
  return made;
}

/// What a daemon handed on. False where it is none of ours.
bool take(int connection, Request& request, ReceivedMessage& handed) noexcept {
  pollfd asked{connection, POLLIN, 0};
  if (poll(&asked, 1, ask_ms) != 1) return false;
  handed = receive_message(connection, std::as_writable_bytes(std::span(&request, 1)));
  const Request ours;
  return handed.bytes == sizeof request && !handed.is_cut && request.magic == ours.magic &&
         request.version == ours.version && handed.count == (request.box_half_bytes > 0 ? 3U : 2U);
}

/// The process of one supervisor, which ends here.
[[noreturn]] void be_supervisor(const OutsideSupervisors& settings, const Request& request,
                                std::span<const Descriptor> handed) noexcept {
  std::signal(SIGCHLD, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  const auto* const beat = map_beat(handed[1].get());
  std::unique_ptr<BlackBoxMemory> box;
  if (request.box_half_bytes > 0 && !settings.black_box.empty()) {
    // Without it a device's force is ended all the same.
    auto attached =
        BlackBoxMemory::attach(handed[2].get(), static_cast<std::size_t>(request.box_half_bytes));
    if (attached) box = std::move(*attached);
  }
  // If this program was started without standard files, the line may have one of their numbers.
  const int line = fcntl(handed[0].get(), F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  if (beat != nullptr && line >= 0) {
    supervise(line, *beat, settings.open, settings.realtime,
              keep_black_box(box.get(), settings.black_box));
  }
  _exit(static_cast<int>(ExitCode::done));
}

/// One daemon that connected.
void welcome(int connection, const OutsideSupervisors& settings) {
  ucred peer{};
  socklen_t size = sizeof peer;
  static_cast<void>(getsockopt(connection, SOL_SOCKET, SO_PEERCRED, &peer, &size));
  const std::string who = "a daemon" + (peer.pid > 0 ? " (process " + std::to_string(peer.pid) + ")"
                                                     : std::string(" in a container"));
  if (!is_trusted(connection)) {
    settings.warn(who + " of user " + std::to_string(peer.uid) +
                  " was refused: run both as the same user");
    return;
  }
  Request request;
  ReceivedMessage handed;
  // A daemon that only looks whether somebody is here asks for nothing.
  if (!take(connection, request, handed)) return;
  const pid_t made = fork();
  if (made == 0) be_supervisor(settings, request, handed.descriptors);
  if (made < 0) {
    settings.warn(who + " got no supervisor (" + std::strerror(errno) +
                  "): raise the limit of processes");
    return;
  }
  settings.tell(who + " has a supervisor (process " + std::to_string(made) + ")");
}

}  // namespace

Result<void> check_outside_supervisor(const std::string& path) {
  if (connect_to(path).get() >= 0) return {};
  return fail(ExitCode::file_or_device,
              path + ": there is no supervisor to ask (" + std::strerror(errno) +
                  "): start 'spm-servo supervise --socket PATH' as this user, outside of what this "
                  "program may be paused with, or run with --supervisor on");
}

Supervisor::StartAgain start_outside(const std::string& path, const BlackBoxMemory* memory) {
  return [path, memory](int line, int beat) -> pid_t {
    const Descriptor connection = connect_to(path);
    if (connection.get() < 0) return -1;
    Request request;
    if (memory != nullptr) request.box_half_bytes = memory->half_bytes();
    const std::array handed{line, beat, memory != nullptr ? memory->descriptor() : -1};
    const auto bytes = std::as_bytes(std::span(&request, 1));
    return send_message(connection.get(), bytes, std::span(handed).first(memory != nullptr ? 3 : 2))
               ? 0
               : -1;
  };
}

Result<void> serve_supervisors(const OutsideSupervisors& settings, const std::atomic<bool>& stop) {
  auto listening = ListeningSocket::open(settings.path, {});
  if (!listening) return tl::make_unexpected(std::move(listening.error()));
  // Supervisors that have ended leave no trace.
  std::signal(SIGCHLD, SIG_IGN);
  settings.tell("listens at " + listening->path());
  while (!stop.load()) {
    pollfd asked{listening->descriptor(), POLLIN, 0};
    if (poll(&asked, 1, look_ms) <= 0) continue;
    const Descriptor connection(
        accept4(listening->descriptor(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (connection.get() >= 0) welcome(connection.get(), settings);
  }
  return {};
}

}  // namespace spm::servo
