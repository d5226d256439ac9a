// SPDX-License-Identifier: Apache-2.0
// Folders in which somebody else could put something of his own in the place of ours.
#include "servo/shared/trusted_folder.hpp"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "servo/shared/socket_path.hpp"
#include "tests/servo/support/connected_client.hpp"
#include "tests/servo/support/loop_stand_in.hpp"

namespace trusted_folder_test {

using namespace spm;
using namespace spm::servo;
using namespace spm::test;

namespace {

constexpr uid_t stranger = 65534;

/// A folder, hostile in one way, in a folder of the test's.
struct Hostile {
  std::string name;
  std::function<void(const std::string&)> make;
  std::string says;
  bool needs_root = false;
};

const std::array<Hostile, 5> all_hostile{{
    {"a link", [](const auto& path) { REQUIRE(symlink("/tmp", path.c_str()) == 0); }, "is a link"},
    {"a file", [](const auto& path) { std::ofstream(path) << "no folder"; }, "is no folder"},
    {"writable by its group",
     [](const auto& path) {
       REQUIRE(mkdir(path.c_str(), 0700) == 0);
       REQUIRE(chmod(path.c_str(), 0770) == 0);
     },
     "open to writing by others"},
    {"writable by everybody, with the sticky bit",
     [](const auto& path) {
       REQUIRE(mkdir(path.c_str(), 0700) == 0);
       REQUIRE(chmod(path.c_str(), 01777) == 0);
     },
     "open to writing by others"},
    {"another user's",
     [](const auto& path) {
       REQUIRE(mkdir(path.c_str(), 0700) == 0);
       REQUIRE(chown(path.c_str(), stranger, stranger) == 0);
     },
     "belongs to another user (65534)", true},
}};

/// Runs a function as another user, in a process of its own, and returns what it returned.
int as_stranger(const std::function<int()>& run) {
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) _exit(setgid(stranger) != 0 || setuid(stranger) != 0 ? 99 : run());
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  REQUIRE(WIFEXITED(status));
  return WEXITSTATUS(status);
}

/// Sets an environment variable, or removes it (null), and puts back what was there at the end.
class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name) {
    const char* const before = std::getenv(name);
    had_ = before != nullptr;
    if (had_) before_ = before;
    value != nullptr ? setenv(name, value, 1) : unsetenv(name);
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;
  ~Environment() { had_ ? setenv(name_, before_.c_str(), 1) : unsetenv(name_); }

 private:
  const char* name_;
  bool had_ = false;
  std::string before_;
};

}  // namespace

TEST_CASE("A folder of one's own is trusted, one that is not there is not to be blamed") {
  const SocketFolder folder;
  CHECK(distrust_of(folder.folder()).empty());
  CHECK(distrust_of(folder.folder() + "/").empty());
  CHECK(distrust_of(folder.path("none/at/all")).empty());
  CHECK(distrust_of("/").empty());
  CHECK(folder_of("a.sock") == ".");
  CHECK(folder_of("/a/b.sock") == "/a");
}

TEST_CASE("A hostile folder is told apart, itself and as a parent") {
  for (const Hostile& hostile : all_hostile) {
    if (hostile.needs_root && geteuid() != 0) continue;
    CAPTURE(hostile.name);
    const SocketFolder folder;
    const std::string path = folder.path("there");
    hostile.make(path);
    CHECK(contains(distrust_of(path), hostile.says));
    CHECK(distrust_of(path).starts_with(path));
    CHECK(contains(distrust_of(path), "mode 700"));
    // Nobody can replace what is not his in a parent with the sticky bit, as in /tmp; and a link of
    // one's own on the way is no danger.
    const bool parent_will_do = contains(hostile.name, "sticky") || hostile.name == "a link";
    static_cast<void>(mkdir((path + "/below-spm-test").c_str(), 0700));
    CHECK(distrust_of(path + "/below-spm-test").empty() == parent_will_do);
    static_cast<void>(rmdir((path + "/below-spm-test").c_str()));
  }
}

TEST_CASE("A link of one's own is followed, and where it leads is looked at too") {
  const SocketFolder folder;
  REQUIRE(mkdir(folder.path("open").c_str(), 0700) == 0);
  REQUIRE(mkdir(folder.path("open/own").c_str(), 0700) == 0);
  REQUIRE(symlink(folder.path("open").c_str(), folder.path("link").c_str()) == 0);
  CHECK(distrust_of(folder.path("link/own")).empty());
  REQUIRE(chmod(folder.path("open").c_str(), 0777) == 0);
  CHECK(contains(distrust_of(folder.path("link/own")), "open is open to writing by others"));
}

TEST_CASE("Another user's link on the way is not followed") {
  if (geteuid() != 0) return;
  const SocketFolder folder;
  REQUIRE(mkdir(folder.path("real").c_str(), 0700) == 0);
  REQUIRE(mkdir(folder.path("real/own").c_str(), 0700) == 0);
  REQUIRE(symlink(folder.path("real").c_str(), folder.path("link").c_str()) == 0);
  CHECK(distrust_of(folder.path("link/own")).empty());
  REQUIRE(lchown(folder.path("link").c_str(), stranger, stranger) == 0);
  CHECK(contains(distrust_of(folder.path("link/own")), "belongs to another user"));
}

TEST_CASE("A user who is trusted may own the folder, and only that one") {
  if (geteuid() != 0) return;
  const SocketFolder folder;
  REQUIRE(chown(folder.folder().c_str(), stranger, stranger) == 0);
  CHECK_FALSE(distrust_of(folder.folder()).empty());
  CHECK(distrust_of(folder.folder(), stranger).empty());
  CHECK_FALSE(distrust_of(folder.folder(), stranger - 1).empty());
}

TEST_CASE("A daemon makes no socket in a hostile folder, and says what to do") {
  for (const Hostile& hostile : all_hostile) {
    if (hostile.needs_root && geteuid() != 0) continue;
    CAPTURE(hostile.name);
    const SocketFolder folder;
    hostile.make(folder.path("there"));
    const auto state = small_state();
    AppServerOptions options;
    options.path = folder.path("there/a.sock");
    const auto server = AppServer::start(options, *state);
    REQUIRE_FALSE(server);
    CHECK(server.error().code == ExitCode::file_or_device);
    CHECK(contains(server.error().message, hostile.says));
    CHECK(contains(server.error().message, "--socket"));
  }
}

TEST_CASE(
    "An application does not speak to a socket in a hostile folder, though a daemon listens") {
  const SocketFolder folder;
  REQUIRE(mkdir(folder.path("there").c_str(), 0700) == 0);
  const auto state = small_state();
  const auto server = started(*state, folder.path("there/a.sock"));
  REQUIRE(Connected(server->path()).code == SPM_CLIENT_OK);
  REQUIRE(chmod(folder.path("there").c_str(), 01777) == 0);
  const Connected open(server->path());
  CHECK(open.code == SPM_CLIENT_REFUSED);
  CHECK(contains(open.message, "open to writing by others"));
  REQUIRE(chmod(folder.path("there").c_str(), 0700) == 0);
  REQUIRE(symlink(folder.path("there").c_str(), folder.path("link").c_str()) == 0);
  const Connected linked(folder.path("link/a.sock"));
  CHECK(linked.code == SPM_CLIENT_REFUSED);
  CHECK(contains(linked.message, "is a link"));
}

TEST_CASE("An application does not speak to another user's daemon unless it is told to") {
  if (geteuid() != 0) return;
  const SocketFolder folder;
  REQUIRE(chmod(folder.folder().c_str(), 0755) == 0);
  REQUIRE(mkdir(folder.path("there").c_str(), 0755) == 0);
  // Root's socket, in root's folder, that a process of another user listens at.
  const std::string path = folder.path("there/a.sock");
  const int listener = new_socket();
  const sockaddr_un address = address_of(path);
  REQUIRE(bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
  const pid_t child = fork();
  if (child == 0) {
    if (setuid(stranger) != 0 || listen(listener, 4) != 0) _exit(1);
    while (true) pause();
  }
  close(listener);
  const auto is_stranger = [&] { return contains(Connected(path, 50).message, "(65534)"); };
  CHECK(eventually(is_stranger));
  CHECK(Connected(path, 50).code == SPM_CLIENT_REFUSED);
  auto options = sized<spm_client_options>();
  options.path = path.c_str();
  options.timeout_ms = 50;
  options.server_user = stranger;
  spm_client* client = nullptr;
  std::array<char, 400> message{};
  // It is asked now, and does not answer.
  CHECK(spm_client_connect(&options, &client, message.data(), message.size()) ==
        SPM_CLIENT_NO_DAEMON);
  CHECK(contains(message.data(), "did not answer"));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
}

TEST_CASE("Without a folder that is the user's alone there is no usual socket, never one in /tmp") {
  if (std::filesystem::exists("/run/user/" + std::to_string(geteuid()))) return;
  const Environment none("XDG_RUNTIME_DIR", nullptr);
  CHECK(socket_folder().empty());
  const auto state = small_state();
  const auto server = AppServer::start({}, *state);
  REQUIRE_FALSE(server);
  CHECK(server.error().code == ExitCode::file_or_device);
  CHECK(contains(server.error().message, "set XDG_RUNTIME_DIR to a folder of yours"));
  CHECK(contains(server.error().message, "--socket"));
  spm_client* client = nullptr;
  std::array<char, 400> message{};
  CHECK(spm_client_connect(nullptr, &client, message.data(), message.size()) ==
        SPM_CLIENT_NO_DAEMON);
  CHECK(contains(message.data(), "set XDG_RUNTIME_DIR to a folder of yours"));
}

TEST_CASE("A group that is given access may connect, others may not, and no group may supervise") {
  if (geteuid() != 0) return;
  const SocketFolder folder;
  REQUIRE(chmod(folder.folder().c_str(), 0755) == 0);
  const auto state = small_state();
  AppServerOptions options;
  options.path = folder.path("a.sock");
  const auto code_as_stranger = [&](std::uint32_t role) {
    return as_stranger([&] {
      auto wish = sized<spm_client_options>();
      wish.path = options.path.c_str();
      wish.timeout_ms = 20000;
      wish.role = role;
      spm_client* client = nullptr;
      return spm_client_connect(&wish, &client, nullptr, 0);
    });
  };
  {
    const auto server = started(*state, options);
    CHECK(code_as_stranger(SPM_CLIENT_APPLICATION) == SPM_CLIENT_REFUSED);
  }
  options.group = stranger;
  const auto server = started(*state, options);
  struct stat status {};
  REQUIRE(stat(options.path.c_str(), &status) == 0);
  CHECK((status.st_mode & 0777) == 0660);
  CHECK(status.st_gid == stranger);
  CHECK(code_as_stranger(SPM_CLIENT_APPLICATION) == SPM_CLIENT_OK);
  CHECK(code_as_stranger(SPM_CLIENT_SUPERVISOR) == SPM_CLIENT_REFUSED);
  AppServerOptions unnamed;
  unnamed.group = stranger;
  const Environment runtime("XDG_RUNTIME_DIR", folder.folder().c_str());
  const auto closed = AppServer::start(unnamed, *state);
  REQUIRE_FALSE(closed);
  CHECK(closed.error().code == ExitCode::usage);
  CHECK(contains(closed.error().message, "--socket"));
}

}  // namespace trusted_folder_test
