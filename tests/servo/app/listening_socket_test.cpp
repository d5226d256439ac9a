// SPDX-License-Identifier: Apache-2.0
#include "servo/app/listening_socket.hpp"

#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <fstream>
#include <string>

#include "tests/servo/support/connected_client.hpp"
#include "tests/servo/support/loop_stand_in.hpp"

namespace listening_socket_test {

using namespace spm;
using namespace spm::servo;
using namespace spm::test;

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
  const int left = new_socket();
  const sockaddr_un address = address_of(path);
  REQUIRE(bind(left, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
  REQUIRE(listen(left, 1) == 0);
  close(left);
  const auto state = small_state();
  const auto server = started(*state, path);
  REQUIRE(Connected(path).code == SPM_CLIENT_OK);
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
