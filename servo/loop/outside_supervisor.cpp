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
#include <utility>

#include "servo/app/listening_socket.hpp"
#include "servo/loop/supervisor_process.hpp"
#include "servo/loop/supervisor_program.hpp"

namespace spm::servo {

namespace {

/// What a daemon asks with; the descriptors come beside it: its line, the beat's memory, and the
/// black box's, if that has bytes.
struct Request {
  std::uint32_t magic = 0x53504d47;  // "SPMG"
  std::uint32_t version = 1;
  std::uint64_t box_half_bytes = 0;
};
constexpr std::size_t most_handed = 3;
/// How long a daemon may take to ask, and this process to look at `stop`, ms.
constexpr int ask_ms = 1000, look_ms = 200;

/// A descriptor that closes itself.
class Handle {
 public:
  explicit Handle(int number = -1) noexcept : number_(number) {}
  Handle(Handle&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (number_ >= 0) close(number_);
  }
  [[nodiscard]] int get() const noexcept { return number_; }

 private:
  int number_;
};

/// Whether the other end belongs to this user, or to root.
bool is_trusted(int connection) noexcept {
  ucred peer{};
  socklen_t size = sizeof peer;
  return getsockopt(connection, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 &&
         (peer.uid == geteuid() || peer.uid == 0);
}

/// Connects to a socket; -1 and an error number where nobody may be trusted there.
Handle connect_to(const std::string& path) noexcept {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) {
    errno = ENAMETOOLONG;
    return Handle();
  }
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  Handle made(socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0));
  if (made.get() < 0 ||
      connect(made.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    return Handle();
  }
  if (!is_trusted(made.get())) {
    errno = EPERM;
    return Handle();
  }
  return made;
}

/// Room for the descriptors that come beside a message.
struct Control {
  alignas(cmsghdr) std::array<unsigned char, CMSG_SPACE(most_handed * sizeof(int))> bytes{};
};

bool hand_on(int connection, Request request, const std::array<int, most_handed>& handed,
             std::size_t count) noexcept {
  iovec part{&request, sizeof request};
  Control control;
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.bytes.data();
  message.msg_controllen = CMSG_SPACE(count * sizeof(int));
  cmsghdr* const header = CMSG_FIRSTHDR(&message);
  header->cmsg_level = SOL_SOCKET;
  header->cmsg_type = SCM_RIGHTS;
  header->cmsg_len = CMSG_LEN(count * sizeof(int));
  std::memcpy(CMSG_DATA(header), handed.data(), count * sizeof(int));
  return sendmsg(connection, &message, MSG_NOSIGNAL) == sizeof request;
}

/// What a daemon handed on. False where it is none of ours.
bool take(int connection, Request& request, std::array<Handle, most_handed>& handed) noexcept {
  pollfd asked{connection, POLLIN, 0};
  if (poll(&asked, 1, ask_ms) != 1) return false;
  iovec part{&request, sizeof request};
  Control control;
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.bytes.data();
  message.msg_controllen = control.bytes.size();
  const ssize_t size = recvmsg(connection, &message, MSG_CMSG_CLOEXEC | MSG_DONTWAIT);
  std::size_t count = 0;
  for (cmsghdr* header = CMSG_FIRSTHDR(&message); size >= 0 && header != nullptr;
       header = CMSG_NXTHDR(&message, header)) {
    if (header->cmsg_level != SOL_SOCKET || header->cmsg_type != SCM_RIGHTS) continue;
    const std::size_t here = (header->cmsg_len - CMSG_LEN(0)) / sizeof(int);
    for (std::size_t i = 0; i < here && count < most_handed; ++i, ++count) {
      int number = -1;
      std::memcpy(&number, CMSG_DATA(header) + i * sizeof number, sizeof number);
      handed[count] = Handle(number);
    }
  }
  const Request ours;
  return size == sizeof request && (message.msg_flags & (MSG_TRUNC | MSG_CTRUNC)) == 0 &&
         request.magic == ours.magic && request.version == ours.version &&
         count == (request.box_half_bytes > 0 ? 3U : 2U);
}

/// The process of one supervisor, which ends here.
[[noreturn]] void be_supervisor(const OutsideSupervisors& settings, const Request& request,
                                const std::array<Handle, most_handed>& handed) noexcept {
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

/// One daemon that connected; a sentence of what became of it.
std::string welcome(int connection, const OutsideSupervisors& settings) {
  ucred peer{};
  socklen_t size = sizeof peer;
  static_cast<void>(getsockopt(connection, SOL_SOCKET, SO_PEERCRED, &peer, &size));
  const std::string who = "a daemon" + (peer.pid > 0 ? " (process " + std::to_string(peer.pid) + ")"
                                                     : std::string(" in a container"));
  if (!is_trusted(connection)) {
    return "warning: " + who + " of user " + std::to_string(peer.uid) +
           " was refused: run both as the same user";
  }
  Request request;
  std::array<Handle, most_handed> handed;
  // A daemon that only looks whether somebody is here asks for nothing.
  if (!take(connection, request, handed)) return {};
  const pid_t made = fork();
  if (made == 0) be_supervisor(settings, request, handed);
  if (made < 0) {
    return "warning: " + who + " got no supervisor (" + std::strerror(errno) +
           "): raise the limit of processes";
  }
  return who + " has a supervisor (process " + std::to_string(made) + ")";
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
    const Handle connection = connect_to(path);
    if (connection.get() < 0) return -1;
    Request request;
    if (memory != nullptr) request.box_half_bytes = memory->half_bytes();
    const std::array<int, most_handed> handed{line, beat,
                                              memory != nullptr ? memory->descriptor() : -1};
    return hand_on(connection.get(), request, handed, memory != nullptr ? 3 : 2) ? 0 : -1;
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
    const Handle connection(
        accept4(listening->descriptor(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (connection.get() < 0) continue;
    const std::string told = welcome(connection.get(), settings);
    if (!told.empty()) settings.tell(told);
  }
  return {};
}

}  // namespace spm::servo
