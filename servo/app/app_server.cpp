// SPDX-License-Identifier: Apache-2.0
#include "servo/app/app_server.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

namespace spm::servo {

namespace {

/// How often the thread looks by itself while it waits for the loop or for a slow client, ms.
constexpr int look_ms = 20;
/// How long it accepts no clients when the process has no descriptors left, ms.
constexpr int rest_ms = 200;
/// As many as a process can be in, on Linux.
constexpr std::size_t max_groups = 65536;
/// So that an application that tries again and again does not fill the log.
constexpr std::uint32_t max_warnings = 100;

/// Starts a thread that receives none of the process's signals.
template <class Run>
std::thread start_without_signals(Run run) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread thread(std::move(run));
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return thread;
}

}  // namespace

Result<std::unique_ptr<AppServer>> AppServer::start(AppServerOptions options, AppState& state) {
  auto socket = ListeningSocket::open(options.path, options.name, options.group);
  if (!socket) return tl::make_unexpected(std::move(socket.error()));
  const int wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (wake < 0) {
    return fail(ExitCode::file_or_device,
                socket->path() + ": the server's thread cannot be woken (" + std::strerror(errno) +
                    "): raise the limit of open files");
  }
  std::unique_ptr<AppServer> server(
      new AppServer(std::move(options), state, std::move(*socket), wake));
  server->thread_ = start_without_signals([raw = server.get()] { raw->run(); });
  return server;
}

AppServer::AppServer(AppServerOptions options, AppState& state, ListeningSocket socket,
                     int wake) noexcept
    : options_(std::move(options)), state_(state), socket_(std::move(socket)), wake_(wake) {}

AppServer::~AppServer() {
  stop_.store(true);
  const std::uint64_t one = 1;
  static_cast<void>(::write(wake_, &one, sizeof one));
  if (thread_.joinable()) thread_.join();
  // Before the sockets close: a client that sees that knows why.
  state_.end();
  for (std::uint32_t place = 0; place < clients_.size(); ++place) {
    if (clients_[place] != nullptr) part(place, "");
  }
  // A tick is short: the loop lets go soon, or has ended.
  while (!departed_.empty()) {
    free_released();
    if (!departed_.empty()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  close(wake_);
}

std::vector<AppClientReport> AppServer::clients() const {
  const std::lock_guard lock(mutex_);
  std::vector<AppClientReport> reports;
  for (const auto& client : clients_) {
    if (client != nullptr && client->ready()) reports.push_back(client->report());
  }
  return reports;
}

void AppServer::run() {
  std::vector<pollfd> watched;
  std::vector<std::uint32_t> places;
  while (!stop_.load()) {
    watched = {{wake_, POLLIN, 0},
               {socket_.descriptor(), static_cast<short>(accepting_ ? POLLIN : 0), 0}};
    places.clear();
    for (std::uint32_t place = 0; place < clients_.size(); ++place) {
      if (clients_[place] == nullptr) continue;
      watched.push_back({clients_[place]->descriptor(), POLLIN, 0});
      places.push_back(place);
    }
    const int timeout = poll_timeout();
    accepting_ = true;
    if (poll(watched.data(), watched.size(), timeout) < 0 && errno != EINTR) {
      warn(std::string("applications can no longer connect (") + std::strerror(errno) + ")");
      return;
    }
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (watched[i + 2].revents != 0) hear(places[i]);
    }
    if (watched[1].revents != 0) accept_one();
    drop_the_slow();
    free_released();
  }
}

int AppServer::poll_timeout() const noexcept {
  if (!accepting_) return rest_ms;
  const bool waiting =
      !departed_.empty() || std::any_of(clients_.begin(), clients_.end(), [](const auto& client) {
        return client != nullptr && !client->ready();
      });
  return waiting ? look_ms : -1;
}

void AppServer::accept_one() {
  const int connection =
      accept4(socket_.descriptor(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (connection >= 0) return welcome(connection);
  if (errno == EMFILE || errno == ENFILE || errno == ENOMEM || errno == ENOBUFS) {
    warn(std::string("an application could not connect (") + std::strerror(errno) +
         "): raise the daemon's limit of open files");
    accepting_ = false;
  }
}

bool AppServer::may_connect(int connection, const ucred& peer) const {
  if (peer.uid == options_.user || peer.uid == 0) return true;
  if (!options_.group) return false;
  if (peer.gid == *options_.group) return true;
  std::vector<gid_t> groups(max_groups);
  auto bytes = static_cast<socklen_t>(groups.size() * sizeof(gid_t));
  if (getsockopt(connection, SOL_SOCKET, SO_PEERGROUPS, groups.data(), &bytes) != 0) return false;
  groups.resize(bytes / sizeof(gid_t));
  return std::find(groups.begin(), groups.end(), *options_.group) != groups.end();
}

/// Takes ownership of the connection.
void AppServer::welcome(int connection) {
  const auto refuse = [connection](const std::string& sentence) {
    static_cast<void>(send_answer(connection, refusing_answer(SPM_SOCKET_REFUSED, sentence)));
    close(connection);
  };
  ucred peer{};
  socklen_t size = sizeof peer;
  if (getsockopt(connection, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) {
    return refuse("the daemon cannot tell who the application belongs to");
  }
  if (!may_connect(connection, peer)) {
    return refuse("the daemon belongs to user " + std::to_string(options_.user) +
                  " and the application to user " + std::to_string(peer.uid) +
                  ": run both as the same user, or start the daemon with --app-group");
  }
  const auto empty = std::find(clients_.begin(), clients_.end(), nullptr);
  if (empty == clients_.end()) {
    return refuse("the daemon has " + std::to_string(SPM_MAX_CLIENTS) +
                  " connections already, as many as it can serve: close one");
  }
  auto client = AppClient::make(connection, connections_ + 1, peer.pid,
                                peer.uid == options_.user || peer.uid == 0);
  if (!client) return warn("an application could not connect: " + client.error().message);
  if (!(*client)->greet(state_.memory())) return;
  ++connections_;
  const std::lock_guard lock(mutex_);
  *empty = std::move(*client);
}

/// Whether one that is ready leaves the applications no more than their places.
bool AppServer::has_place(const AppClient& client) const {
  const auto is_application = [](const AppClientReport& one) {
    return !one.supervisor && !one.observer;
  };
  const auto ready = clients();
  return !is_application(client.report()) ||
         std::count_if(ready.begin(), ready.end(), is_application) <= SPM_MAX_APPLICATIONS;
}

void AppServer::hear(std::uint32_t place) {
  Heard heard = Heard::nothing;
  {
    const std::lock_guard lock(mutex_);
    heard = clients_[place]->hear();
  }
  switch (heard) {
    case Heard::nothing:
      return;
    case Heard::ready:
      if (!has_place(*clients_[place])) {
        clients_[place]->refuse(SPM_SOCKET_REFUSED,
                                "the daemon has " + std::to_string(SPM_MAX_APPLICATIONS) +
                                    " applications already, as many as it can serve: close one");
        return part(place, "");
      }
      state_.rings()[place].offer(clients_[place]->ring());
      state_.tell_clients(clients());
      if (!clients_[place]->confirm()) part(place, "");
      return;
    case Heard::gone:
      return part(place, "");
    case Heard::nonsense:
      return part(place, "what it sent was no message of this version's library");
  }
}

/// Lets a client go. Its ring is freed when the loop no longer uses it.
void AppServer::part(std::uint32_t place, const std::string& why) {
  state_.rings()[place].offer(nullptr);
  {
    const std::lock_guard lock(mutex_);
    if (!why.empty()) {
      warn("application of process " + std::to_string(clients_[place]->report().process) +
           " was let go: " + why);
    }
    clients_[place]->hang_up();
    departed_.push_back(std::move(clients_[place]));
  }
  state_.tell_clients(clients());
}

void AppServer::drop_the_slow() {
  const auto now = std::chrono::steady_clock::now();
  for (std::uint32_t place = 0; place < clients_.size(); ++place) {
    const auto& client = clients_[place];
    if (client == nullptr || client->ready() || now - client->since() < options_.patience) continue;
    part(place, "it did not say in time that it has mapped the memory it was sent");
  }
}

void AppServer::free_released() {
  std::erase_if(departed_, [this](const std::unique_ptr<AppClient>& client) {
    const auto& rings = state_.rings();
    return std::all_of(rings.begin(), rings.end(),
                       [&](const ClientRing& ring) { return ring.released(client->ring()); });
  });
}

void AppServer::warn(const std::string& message) {
  if (!options_.warn || warnings_ > max_warnings) return;
  ++warnings_;
  options_.warn(warnings_ > max_warnings ? "further messages about applications are left out"
                                         : message);
}

}  // namespace spm::servo
