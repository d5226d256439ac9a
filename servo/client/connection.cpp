// SPDX-License-Identifier: Apache-2.0
#include "servo/client/connection.hpp"

#include <poll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <span>
#include <thread>
#include <utility>

#include "servo/client/spm_client.h"
#include "servo/shared/passed_descriptors.hpp"
#include "servo/shared/shared_words.hpp"
#include "servo/shared/socket_messages.h"
#include "servo/shared/socket_path.hpp"
#include "servo/shared/trusted_folder.hpp"

namespace spm::servo {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds retry_interval{5};
/// Size of the fields of an answer that are at the same place in all versions.
constexpr std::size_t answer_head_bytes = 16;

tl::unexpected<NoConnection> without(int code, std::string sentence) {
  return tl::make_unexpected(NoConnection{code, std::move(sentence)});
}

std::string text_of(const char* text, std::size_t size) {
  return std::string(text, strnlen(text, size));
}

/// Maps a region. Null if it is smaller than it must be, or the system refuses.
void* map_region(int descriptor, std::size_t bytes, int protection) noexcept {
  struct stat status {};
  if (fstat(descriptor, &status) != 0 || status.st_size < static_cast<off_t>(bytes)) return nullptr;
  void* const data = mmap(nullptr, bytes, protection, MAP_SHARED | MAP_POPULATE, descriptor, 0);
  return data == MAP_FAILED ? nullptr : data;
}

}  // namespace

/// The steps from a path to a connection.
class Handshake {
 public:
  explicit Handshake(const ConnectionRequest& request)
      : request_(request), deadline_(Clock::now() + request.timeout) {}

  [[nodiscard]] tl::expected<Connection, NoConnection> run() {
    if (auto done = connect_socket(); !done) return tl::make_unexpected(done.error());
    if (auto done = check_server(); !done) return tl::make_unexpected(done.error());
    spm_socket_answer answer{};
    ReceivedMessage received;
    if (auto done = hear(answer, received); !done) return tl::make_unexpected(done.error());
    if (auto done = map(answer, received); !done) return tl::make_unexpected(done.error());
    if (auto done = say_ready(); !done) return tl::make_unexpected(done.error());
    ReceivedMessage none;
    if (auto done = hear(answer, none); !done) return tl::make_unexpected(done.error());
    connection_.number_ = answer.connection;
    return std::move(connection_);
  }

 private:
  using Step = tl::expected<void, NoConnection>;

  [[nodiscard]] Step connect_socket() {
    if (path_.empty() || path_.size() > longest_socket_path) {
      return without(SPM_CLIENT_BAD_ARGUMENT, "'" + path_ +
                                                  "' cannot be a socket: its path must have 1 to " +
                                                  std::to_string(longest_socket_path) + " bytes");
    }
    const std::string fault = distrust_of(folder_of(path_), request_.server_user);
    if (!fault.empty()) {
      return without(SPM_CLIENT_REFUSED, "the socket " + path_ + " cannot be trusted: " + fault +
                                             ", or name the daemon's user as server_user "
                                             "(spm-servo top: --server-user) if the folder is "
                                             "theirs");
    }
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path_.c_str(), path_.size() + 1);
    connection_.socket_ = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (connection_.socket_ < 0) {
      return without(SPM_CLIENT_INTERNAL, std::string("no socket could be made (") +
                                              std::strerror(errno) +
                                              "): raise the limit of open files");
    }
    while (connect(connection_.socket_, reinterpret_cast<const sockaddr*>(&address),
                   sizeof address) != 0) {
      // Many clients connect at once, and the daemon has not come to this one.
      if ((errno != EAGAIN && errno != EINTR) || Clock::now() >= deadline_) return no_daemon(errno);
      std::this_thread::sleep_for(retry_interval);
    }
    return {};
  }

  /// Whether what listens belongs to this user, to root, or to who the caller trusts.
  [[nodiscard]] Step check_server() const {
    ucred peer{};
    socklen_t size = sizeof peer;
    const bool told = getsockopt(connection_.socket_, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0;
    if (told && (peer.uid == 0 || peer.uid == geteuid() || peer.uid == request_.server_user)) {
      return {};
    }
    return without(SPM_CLIENT_REFUSED,
                   "what answers at " + path_ + " belongs to another user (" +
                       (told ? std::to_string(peer.uid) : "unknown") +
                       "): name that user as server_user (spm-servo top: --server-user) if the "
                       "daemon is theirs and you trust it, or name another socket");
  }

  [[nodiscard]] Step no_daemon(int code) const {
    const std::string begin = "no daemon answers at " + path_ + ": ";
    if (code == ENOENT || code == ENOTDIR) {
      return without(SPM_CLIENT_NO_DAEMON,
                     begin +
                         "there is no such socket; start one with 'spm-servo run', as the same "
                         "user, or name the socket of the one that runs");
    }
    if (code == ECONNREFUSED) {
      return without(SPM_CLIENT_NO_DAEMON, begin +
                                               "the daemon that made this socket has ended; "
                                               "start one with 'spm-servo run'");
    }
    if (code == EACCES || code == EPERM) {
      return without(SPM_CLIENT_REFUSED, begin +
                                             "the socket belongs to another user; run daemon "
                                             "and application as the same user");
    }
    if (code == EAGAIN) {
      return without(SPM_CLIENT_NO_DAEMON, begin +
                                               "too many applications connect at once, or the "
                                               "daemon is stopped; try again, or look at it "
                                               "with 'spm-servo top'");
    }
    return without(SPM_CLIENT_NO_DAEMON,
                   begin + std::strerror(code) + "; is it the socket of 'spm-servo run'?");
  }

  [[nodiscard]] Step wait() const {
    while (true) {
      const auto left =
          std::chrono::duration_cast<std::chrono::milliseconds>(deadline_ - Clock::now()).count();
      pollfd watched{connection_.socket_, POLLIN, 0};
      const int found = poll(&watched, 1, static_cast<int>(std::max<long long>(0, left)));
      if (found > 0) return {};
      if (found < 0 && errno == EINTR) continue;
      return without(SPM_CLIENT_NO_DAEMON,
                     "the daemon at " + path_ + " did not answer within " +
                         std::to_string(request_.timeout.count()) +
                         " ms: it is stopped or the machine is overloaded; continue it, or start "
                         "it again");
    }
  }

  /// Receives an answer. An answer that is no welcome is an error.
  [[nodiscard]] Step hear(spm_socket_answer& answer, ReceivedMessage& received) {
    if (auto ready = wait(); !ready) return ready;
    received = receive_message(connection_.socket_, std::as_writable_bytes(std::span(&answer, 1)));
    const ssize_t got = received.bytes;
    if (got <= 0) {
      return without(SPM_CLIENT_NO_DAEMON,
                     "the daemon at " + path_ +
                         " hung up while the application connected: it is ending, or has no memory "
                         "left; look at its messages and try again");
    }
    if (static_cast<std::size_t>(got) < answer_head_bytes || answer.magic != SPM_SOCKET_MAGIC) {
      return without(
          SPM_CLIENT_VERSION_DIFFERS,
          "what answers at " + path_ + " is no spm-servo: name the socket of 'spm-servo run'");
    }
    if (got != sizeof answer || answer.socket_version != SPM_SOCKET_VERSION ||
        answer.layout_version != SPM_LAYOUT_VERSION) {
      return without(
          SPM_CLIENT_VERSION_DIFFERS,
          "the daemon at " + path_ + " has layout " + std::to_string(answer.layout_version) +
              ", this library " + std::to_string(SPM_LAYOUT_VERSION) +
              " (version " SPM_VERSION "): install library and daemon of the same version");
    }
    if (answer.status == SPM_SOCKET_WELCOME) return {};
    return without(
        answer.status == SPM_SOCKET_OTHER_VERSION ? SPM_CLIENT_VERSION_DIFFERS : SPM_CLIENT_REFUSED,
        "the daemon at " + path_ +
            " refused the application: " + text_of(answer.sentence, sizeof answer.sentence));
  }

  [[nodiscard]] Step map(const spm_socket_answer& answer, const ReceivedMessage& received) {
    const bool sized = answer.state_bytes == sizeof(spm_shared_state) &&
                       answer.ring_bytes == sizeof(spm_shared_ring);
    if (sized) {
      connection_.state_ = static_cast<const spm_shared_state*>(
          map_region(received.descriptors[0].get(), sizeof(spm_shared_state), PROT_READ));
      connection_.ring_ = static_cast<spm_shared_ring*>(map_region(
          received.descriptors[1].get(), sizeof(spm_shared_ring), PROT_READ | PROT_WRITE));
    }
    if (connection_.state_ == nullptr || connection_.ring_ == nullptr) {
      return without(SPM_CLIENT_INTERNAL,
                     "the memory of the daemon at " + path_ +
                         " could not be mapped: free some memory or raise the limit of address "
                         "space");
    }
    if (connection_.state_->magic != SPM_STATE_MAGIC ||
        connection_.state_->layout_version != SPM_LAYOUT_VERSION ||
        connection_.ring_->magic != SPM_RING_MAGIC) {
      return without(SPM_CLIENT_VERSION_DIFFERS,
                     "the memory of the daemon at " + path_ +
                         " is of another layout than this library's: install library and daemon "
                         "of the same version");
    }
    return {};
  }

  [[nodiscard]] Step say_ready() {
    const std::string& application = request_.application;
    spm_socket_ready ready{};
    ready.magic = SPM_SOCKET_MAGIC;
    ready.socket_version = SPM_SOCKET_VERSION;
    ready.layout_version = SPM_LAYOUT_VERSION;
    std::memcpy(ready.library_version, SPM_VERSION, sizeof SPM_VERSION);
    static_assert(sizeof SPM_VERSION <= sizeof ready.library_version);
    std::memcpy(ready.application, application.data(),
                std::min(application.size(), sizeof ready.application - 1));
    ready.role = request_.role;
    if (send(connection_.socket_, &ready, sizeof ready, MSG_DONTWAIT | MSG_NOSIGNAL) ==
        sizeof ready) {
      return {};
    }
    return without(SPM_CLIENT_NO_DAEMON, "the daemon at " + path_ +
                                             " hung up while the application connected: look at "
                                             "its messages and try again");
  }

  const ConnectionRequest& request_;
  const std::string& path_ = request_.path;
  Clock::time_point deadline_;
  Connection connection_;
};

tl::expected<Connection, NoConnection> Connection::open(const ConnectionRequest& request) {
  return Handshake(request).run();
}

Connection::Connection(Connection&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)),
      state_(std::exchange(other.state_, nullptr)),
      ring_(std::exchange(other.ring_, nullptr)),
      number_(other.number_) {}

Connection::~Connection() {
  if (state_ != nullptr) munmap(const_cast<spm_shared_state*>(state_), sizeof(spm_shared_state));
  if (ring_ != nullptr) munmap(ring_, sizeof(spm_shared_ring));
  if (socket_ >= 0) close(socket_);
}

bool Connection::daemon_is_there() const noexcept {
  char byte = 0;
  const ssize_t got = recv(socket_, &byte, 1, MSG_DONTWAIT | MSG_PEEK);
  return got > 0 || (got < 0 && (errno == EAGAIN || errno == EINTR));
}

}  // namespace spm::servo
