// SPDX-License-Identifier: Apache-2.0
#include "servo/app/listening_socket.hpp"

#include <sys/inotify.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "servo/shared/trusted_folder.hpp"
#include "tests/servo/support/connected_client.hpp"
#include "tests/servo/support/loop_stand_in.hpp"

namespace listening_socket_test {

using namespace spm;
using namespace spm::servo;
using namespace spm::test;

namespace {

/// What a daemon leaves that was killed.
void leave_socket(const std::string& path) {
  const int left = new_socket();
  const sockaddr_un address = address_of(path);
  REQUIRE(bind(left, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
  REQUIRE(listen(left, 1) == 0);
  close(left);
}

}  // namespace

TEST_CASE("A second daemon at the same socket is refused with a sentence") {
  const SocketFolder folder;
  const auto state = small_state();
  const auto server = started(*state, folder.path("a.sock"));
  const auto other = small_state();
  AppServerOptions options;
  options.path = server->path();
  const auto second = AppServer::start(options, *other);
  REQUIRE_FALSE(second);
  REQUIRE(second.error().code == ExitCode::invalid_input);
  REQUIRE(contains(second.error().message, "that runs already: end that one, or"));
  const auto asked_before = ListeningSocket::check_free(server->path(), "default");
  REQUIRE_FALSE(asked_before);
  REQUIRE(asked_before.error().message == second.error().message);
  REQUIRE(contains(second.error().message, "process " + std::to_string(getpid())));
  REQUIRE(Connected(server->path()).code == SPM_CLIENT_OK);
}

TEST_CASE("A socket that an ended daemon left behind is taken over") {
  const SocketFolder folder;
  const std::string path = folder.path("a.sock");
  leave_socket(path);
  const auto state = small_state();
  const auto server = started(*state, path);
  REQUIRE(Connected(path).code == SPM_CLIENT_OK);
}

TEST_CASE("A socket has its name only once it listens") {
  const SocketFolder folder;
  const std::string path = folder.path("a.sock");
  const std::string place = folder_of(path);
  SECTION("where nothing lies") {}
  SECTION("where an ended daemon left one") { leave_socket(path); }
  const int watch = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
  REQUIRE(watch >= 0);
  REQUIRE(inotify_add_watch(watch, place.c_str(), IN_CREATE | IN_DELETE | IN_MOVED_TO) >= 0);
  const auto socket = ListeningSocket::open(path, "default", std::nullopt);
  REQUIRE(socket);
  alignas(inotify_event) std::array<char, 4096> events{};
  const ssize_t size = read(watch, events.data(), events.size());
  close(watch);
  std::vector<std::uint32_t> seen;
  for (ssize_t at = 0; at < size;) {
    const auto* event = reinterpret_cast<const inotify_event*>(events.data() + at);
    if (std::string(event->name) == "a.sock") seen.push_back(event->mask);
    at += static_cast<ssize_t>(sizeof *event + event->len);
  }
  REQUIRE(seen == std::vector<std::uint32_t>{IN_MOVED_TO});
  // Nothing else is left there.
  REQUIRE(std::distance(std::filesystem::directory_iterator(place), {}) == 1);
}

TEST_CASE("A file that is no socket is left alone") {
  const SocketFolder folder;
  const std::string path = folder.path("letters");
  std::ofstream(path) << "dear";
  const auto state = small_state();
  AppServerOptions options;
  options.path = path;
  const auto server = AppServer::start(options, *state);
  REQUIRE_FALSE(server);
  REQUIRE(contains(server.error().message, "is no socket"));
  std::string word;
  std::ifstream(path) >> word;
  REQUIRE(word == "dear");
}

TEST_CASE("The socket goes with the server, and one that took its place stays") {
  const SocketFolder folder;
  const std::string path = folder.path("a.sock");
  const auto state = small_state();
  auto server = started(*state, path);
  server.reset();
  REQUIRE(access(path.c_str(), F_OK) != 0);

  server = started(*state, path);
  REQUIRE(unlink(path.c_str()) == 0);
  const auto other = small_state();
  const auto second = started(*other, path);
  server.reset();
  REQUIRE(Connected(path).code == SPM_CLIENT_OK);
}

TEST_CASE("The usual socket lies in a private folder of the user's") {
  const SocketFolder folder;
  const char* const before = std::getenv("XDG_RUNTIME_DIR");
  const std::string kept = before != nullptr ? before : "";
  setenv("XDG_RUNTIME_DIR", folder.folder().c_str(), 1);
  const auto state = small_state();
  {
    AppServerOptions options;
    options.name = "lab-2";
    const auto server = started(*state, options);
    REQUIRE(server->path() == folder.path("spm-servo/lab-2.sock"));
    struct stat status {};
    REQUIRE(stat(folder.path("spm-servo").c_str(), &status) == 0);
    REQUIRE((status.st_mode & 0777) == 0700);
  }
  REQUIRE(chmod(folder.path("spm-servo").c_str(), 0755) == 0);
  const auto open = AppServer::start({}, *state);
  REQUIRE_FALSE(open);
  REQUIRE(contains(open.error().message, "chmod 700"));
  AppServerOptions wrong;
  wrong.name = "../evil";
  const auto named = AppServer::start(wrong, *state);
  REQUIRE_FALSE(named);
  REQUIRE(named.error().code == ExitCode::usage);
  AppServerOptions too_long;
  too_long.path = folder.path(std::string(120, 'x'));
  const auto lengthy = AppServer::start(too_long, *state);
  REQUIRE_FALSE(lengthy);
  REQUIRE(lengthy.error().code == ExitCode::usage);
  if (before != nullptr) {
    setenv("XDG_RUNTIME_DIR", kept.c_str(), 1);
  } else {
    unsetenv("XDG_RUNTIME_DIR");
  }
}

}  // namespace listening_socket_test
