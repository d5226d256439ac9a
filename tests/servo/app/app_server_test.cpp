// SPDX-License-Identifier: Apache-2.0
#include "servo/app/app_server.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <thread>

#include "servo/client/spm_client.h"
#include "servo/shared/shared_words.hpp"
#include "servo/shared/socket_messages.h"
#include "tests/servo/support/connected_client.hpp"
#include "tests/servo/support/loop_stand_in.hpp"

namespace app_server_test {

using namespace spm;
using namespace spm::servo;
using namespace spm::test;

namespace {

/// A client that does not use the library.
class RawClient {
 public:
  explicit RawClient(const std::string& path) : socket_(new_socket()) {
    const sockaddr_un address = address_of(path);
    REQUIRE(connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
  }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;
  ~RawClient() {
    for (const int descriptor : {socket_, state, ring}) {
      if (descriptor >= 0) close(descriptor);
    }
  }

  /// The daemon's next answer, with its descriptors; false where it hung up.
  bool hear(spm_socket_answer& answer) {
    iovec part{&answer, sizeof answer};
    alignas(cmsghdr) std::array<unsigned char, CMSG_SPACE(2 * sizeof(int))> control{};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    pollfd watched{socket_, POLLIN, 0};
    REQUIRE(poll(&watched, 1, 20000) == 1);
    if (recvmsg(socket_, &message, MSG_CMSG_CLOEXEC) != sizeof answer) return false;
    const cmsghdr* const header = CMSG_FIRSTHDR(&message);
    if (header != nullptr && header->cmsg_len == CMSG_LEN(2 * sizeof(int))) {
      std::memcpy(&state, CMSG_DATA(header), sizeof state);
      std::memcpy(&ring, CMSG_DATA(header) + sizeof state, sizeof ring);
    }
    return true;
  }

  bool say(const void* bytes, std::size_t size) const {
    return send(socket_, bytes, size, MSG_NOSIGNAL) == static_cast<ssize_t>(size);
  }
  bool say_ready(std::uint32_t layout = SPM_LAYOUT_VERSION) const {
    spm_socket_ready ready{};
    ready.magic = SPM_SOCKET_MAGIC;
    ready.socket_version = SPM_SOCKET_VERSION;
    ready.layout_version = layout;
    std::strcpy(ready.application, "raw\nclient");
    return say(&ready, sizeof ready);
  }
  /// Whether the daemon hangs up.
  bool is_let_go() {
    return eventually([this] {
      char byte = 0;
      const ssize_t got = recv(socket_, &byte, 1, MSG_DONTWAIT);
      return got == 0 || (got < 0 && errno != EAGAIN);
    });
  }

  int state = -1, ring = -1;

 private:
  int socket_;
};

/// Runs a function in a process of its own until it is killed.
pid_t in_a_process(const std::function<void()>& run) {
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    run();
    _exit(0);
  }
  return child;
}

void flood(const std::string& path) {
  spm_client_options options{};
  options.size = sizeof options;
  options.path = path.c_str();
  options.timeout_ms = 20000;
  spm_client* client = nullptr;
  if (spm_client_connect(&options, &client, nullptr, 0) != SPM_CLIENT_OK) _exit(1);
  spm_client_pose pose{};
  pose.size = sizeof pose;
  pose.orientation[0] = 1;
  while (true) static_cast<void>(spm_client_move_object(client, 0, &pose));
}

/// Takes all places that applications have.
std::vector<std::unique_ptr<Connected>> all_applications(const std::string& path) {
  std::vector<std::unique_ptr<Connected>> clients;
  for (int i = 0; i < SPM_MAX_APPLICATIONS; ++i) {
    clients.push_back(std::make_unique<Connected>(path));
    REQUIRE(clients.back()->message.empty());
  }
  return clients;
}

}  // namespace

TEST_CASE("A client is greeted with versions and two descriptors, and served once it is ready") {
  const SocketFolder folder;
  const auto state = small_state();
  const auto server = started(*state, folder.path("a.sock"));
  RawClient client(server->path());
  spm_socket_answer answer{};
  REQUIRE(client.hear(answer));
  REQUIRE(answer.magic == SPM_SOCKET_MAGIC);
  REQUIRE(answer.status == SPM_SOCKET_WELCOME);
  REQUIRE(answer.layout_version == SPM_LAYOUT_VERSION);
  REQUIRE(answer.connection == 1);
  REQUIRE(client.state >= 0);
  REQUIRE(client.ring >= 0);
  REQUIRE(server->clients().empty());
  REQUIRE(client.say_ready());
  REQUIRE(client.hear(answer));
  REQUIRE(answer.status == SPM_SOCKET_WELCOME);
  REQUIRE(eventually([&] { return server->clients().size() == 1; }));
  const AppClientReport report = server->clients()[0];
  REQUIRE(report.process == getpid());
  REQUIRE(report.connection == 1);
  REQUIRE(report.application == "raw?client");
}

TEST_CASE("A client that is served can neither cut its ring nor take pages out of it") {
  const SocketFolder folder;
  const auto state = small_state();
  const auto server = started(*state, folder.path("a.sock"));
  RawClient client(server->path());
  spm_socket_answer answer{};
  REQUIRE(client.hear(answer));
  void* const ring =
      mmap(nullptr, answer.ring_bytes, PROT_READ | PROT_WRITE, MAP_SHARED, client.ring, 0);
  REQUIRE(ring != MAP_FAILED);
  REQUIRE(client.say_ready());
  REQUIRE(client.hear(answer));
  REQUIRE(ftruncate(client.ring, 0) != 0);
  REQUIRE(fallocate(client.ring, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 0, 4096) != 0);
  REQUIRE(madvise(ring, 4096, MADV_REMOVE) != 0);
  // The client can still write to memory that it mapped before.
  auto* const shared = static_cast<spm_shared_ring*>(ring);
  store_release(shared->head, std::uint64_t{1} << 40U);
  const LoopStandIn loop(*state);
  REQUIRE(eventually([&] { return load_acquire(shared->tail) == std::uint64_t{1} << 40U; }));
  REQUIRE(state->counters().garbage == 1);
  munmap(ring, sizeof(spm_shared_ring));
}

TEST_CASE(
    "The seventeenth application is refused with a sentence, and welcome when another has gone") {
  const SocketFolder folder;
  const auto state = small_state();
  const auto server = started(*state, folder.path("a.sock"));
  auto clients = all_applications(server->path());
  const Connected one_too_many(server->path());
  REQUIRE(one_too_many.code == SPM_CLIENT_REFUSED);
  REQUIRE(contains(one_too_many.message, "16 applications already"));
  clients.pop_back();
  REQUIRE(eventually([&] { return Connected(server->path()).code == SPM_CLIENT_OK; }));
}

TEST_CASE("Supervisors and observers take none of the sixteen places for applications") {
  const SocketFolder folder;
  const auto state = small_state();
  const auto server = started(*state, folder.path("a.sock"));
  std::vector<std::unique_ptr<Connected>> beside;
  for (const auto role : {SPM_CLIENT_OBSERVER, SPM_CLIENT_SUPERVISOR, SPM_CLIENT_OBSERVER}) {
    beside.push_back(std::make_unique<Connected>(server->path(), 20000, role));
    REQUIRE(beside.back()->message.empty());
  }
  const auto clients = all_applications(server->path());
  const Connected last(server->path(), 20000, SPM_CLIENT_OBSERVER);
  REQUIRE(last.code == SPM_CLIENT_OK);
  const Connected one_too_many(server->path(), 20000, SPM_CLIENT_OBSERVER);
  REQUIRE(one_too_many.code == SPM_CLIENT_REFUSED);
  REQUIRE(contains(one_too_many.message, "20 connections already"));
}

TEST_CASE("The loop refuses all commands of an observer, with a sentence") {
  const SocketFolder folder;
  const auto state = small_state();
  const auto server = started(*state, folder.path("a.sock"));
  const LoopStandIn loop(*state);
  const Connected observer(server->path(), 20000, SPM_CLIENT_OBSERVER);
  const spm_client_pose pose = pose_at(0);
  auto counts = sized<spm_client_command_counts>();
  REQUIRE(spm_client_move_object(observer.client, 0, &pose) == SPM_CLIENT_OK);
  REQUIRE(eventually([&] {
    return spm_client_refusals(observer.client, &counts) == SPM_CLIENT_OK && counts.refused == 1;
  }));
  REQUIRE(contains(spm_client_refusal(counts.last_refusal), "an observer only watches"));
  REQUIRE(state->counters().taken == 0);
}

TEST_CASE("Clients that come and go leave nothing behind") {
  const SocketFolder folder;
  const auto state = small_state();
  const auto server = started(*state, folder.path("a.sock"));
  const LoopStandIn loop(*state);
  for (int i = 0; i < 200; ++i) {
    const Connected client(server->path());
    REQUIRE(client.message.empty());
    if (i % 2 == 0) REQUIRE(client.commands_work());
  }
  REQUIRE(eventually([&] { return server->clients().empty(); }));
}

TEST_CASE("A client that sends nonsense is let go, and the others are not disturbed") {
  const SocketFolder folder;
  const auto state = small_state();
  const LoopStandIn loop(*state);
  const auto server = started(*state, folder.path("a.sock"));
  const Connected good(server->path());
  REQUIRE(good.code == SPM_CLIENT_OK);
  const std::string nonsense(70000, 'x');
  for (const std::size_t size : {std::size_t{1}, std::size_t{15}, sizeof(spm_socket_ready),
                                 std::size_t{5000}, nonsense.size()}) {
    RawClient bad(server->path());
    spm_socket_answer answer{};
    REQUIRE(bad.hear(answer));
    REQUIRE(bad.say(nonsense.data(), size));
    REQUIRE(bad.is_let_go());
  }
  // A correct beginning is not enough.
  RawClient bad(server->path());
  spm_socket_answer answer{};
  REQUIRE(bad.hear(answer));
  REQUIRE(bad.say_ready());
  REQUIRE(bad.hear(answer));
  static_cast<void>(bad.say_ready());
  REQUIRE(bad.is_let_go());
  REQUIRE(good.commands_work());
}

TEST_CASE("A client that never says that it is ready is let go") {
  const SocketFolder folder;
  const auto state = small_state();
  AppServerOptions options;
  options.path = folder.path("a.sock");
  options.patience = std::chrono::milliseconds(50);
  const auto server = started(*state, options);
  RawClient slow(server->path());
  spm_socket_answer answer{};
  REQUIRE(slow.hear(answer));
  REQUIRE(slow.is_let_go());
}

TEST_CASE("A client of another version is told so in a sentence") {
  const SocketFolder folder;
  const auto state = small_state();
  const auto server = started(*state, folder.path("a.sock"));
  RawClient client(server->path());
  spm_socket_answer answer{};
  REQUIRE(client.hear(answer));
  REQUIRE(client.say_ready(99));
  REQUIRE(client.hear(answer));
  REQUIRE(answer.status == SPM_SOCKET_OTHER_VERSION);
  REQUIRE(contains(answer.sentence, "layout 99"));
  REQUIRE(contains(answer.sentence, "same version"));
  REQUIRE(client.is_let_go());
}

TEST_CASE("Another user's application is refused with a sentence") {
  const SocketFolder folder;
  const auto state = small_state();
  AppServerOptions options;
  options.path = folder.path("a.sock");
  if (geteuid() != 0) {
    // A daemon that serves somebody else.
    options.user = geteuid() + 1;
    const auto server = started(*state, options);
    const Connected client(options.path);
    REQUIRE(client.code == SPM_CLIENT_REFUSED);
    REQUIRE(contains(client.message, "run both as the same user"));
    return;
  }
  const auto server = started(*state, options);
  REQUIRE(chmod(folder.folder().c_str(), 0755) == 0);
  REQUIRE(chmod(options.path.c_str(), 0777) == 0);
  constexpr uid_t nobody = 65534;
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    if (setuid(nobody) != 0) _exit(9);
    spm_client_options wish{};
    wish.size = sizeof wish;
    wish.timeout_ms = 20000;
    wish.path = options.path.c_str();
    spm_client* client = nullptr;
    std::array<char, 400> message{};
    const int code = spm_client_connect(&wish, &client, message.data(), message.size());
    const bool told = std::strstr(message.data(), "run both as the same user") != nullptr;
    _exit(code == SPM_CLIENT_REFUSED && told ? 0 : 1);
  }
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  REQUIRE(WIFEXITED(status));
  REQUIRE(WEXITSTATUS(status) == 0);
}

TEST_CASE("Clients that flood and are killed disturb neither the loop nor another client") {
  const SocketFolder folder;
  const auto state = small_state();
  const auto server = started(*state, folder.path("a.sock"));
  const std::string path = server->path();
  const LoopStandIn loop(*state);
  const Connected good(path);
  REQUIRE(good.code == SPM_CLIENT_OK);
  for (int round = 0; round < 5; ++round) {
    std::vector<pid_t> children;
    for (int i = 0; i < 4; ++i) {
      children.push_back(in_a_process([&] { flood(path); }));
    }
    REQUIRE(eventually([&] { return server->clients().size() == 5; }));
    REQUIRE(eventually([&] {
      const auto clients = server->clients();
      return std::all_of(clients.begin(), clients.end(), [](const AppClientReport& client) {
        return client.application == "test" || client.commands > 100;
      });
    }));
    REQUIRE(good.commands_work());
    for (const pid_t child : children) {
      REQUIRE(kill(child, SIGKILL) == 0);
      REQUIRE(waitpid(child, nullptr, 0) == child);
    }
    REQUIRE(eventually([&] { return server->clients().size() == 1; }));
    REQUIRE(good.commands_work());
  }
  REQUIRE(eventually([&] { return loop.departures() == 20; }));
}

TEST_CASE("The server ends while clients are connected and the loop runs") {
  const SocketFolder folder;
  const auto state = small_state();
  const LoopStandIn loop(*state);
  auto server = started(*state, folder.path("a.sock"));
  const Connected client(server->path());
  REQUIRE(client.commands_work());
  server.reset();
  REQUIRE(eventually([&] { return loop.departures() == 1; }));
  REQUIRE(spm_client_daemon_state(client.client, nullptr) == SPM_CLIENT_ENDED);
}

}  // namespace app_server_test
