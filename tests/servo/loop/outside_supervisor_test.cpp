// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/outside_supervisor.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <csignal>
#include <memory>
#include <string>
#include <utility>

#include "servo/base/clock.hpp"
#include "tests/servo/support/eventually.hpp"
#include "tests/servo/support/log_file.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace outside_supervisor_test {

using namespace spm::servo;
using spm::test::append;
using spm::test::content;
using spm::test::eventually;
using spm::test::TemporaryFolder;

namespace {

std::atomic<bool> ends{false};
extern "C" void end_it(int) { ends.store(true); }

/// A process that makes supervisors, whose devices write down what they are sent.
class Outside {
 public:
  Outside() {
    process_ = fork();
    if (process_ != 0) return;
    std::signal(SIGTERM, end_it);
    OutsideSupervisors settings;
    settings.path = path();
    settings.realtime = RealtimeMode::off;
    settings.open = [log = log()](const std::string& target) -> spm::Result<ZeroForce> {
      return ZeroForce([log, target] {
        append(log, "zero to " + target);
        return true;
      });
    };
    settings.tell = [told = folder_.file("told")](const std::string& text) { append(told, text); };
    settings.warn = settings.tell;
    _exit(serve_supervisors(settings, ends) ? 0 : 1);
  }
  Outside(const Outside&) = delete;
  Outside& operator=(const Outside&) = delete;
  ~Outside() { static_cast<void>(end()); }

  [[nodiscard]] std::string path() const { return folder_.file("supervisor.sock"); }
  [[nodiscard]] std::string log() const { return folder_.file("log"); }
  [[nodiscard]] std::string told() const { return content(folder_.file("told")); }
  [[nodiscard]] bool listens() const {
    return eventually([&] { return check_outside_supervisor(path()).has_value(); });
  }
  /// Ends it as a user does; its exit code.
  int end() {
    if (process_ <= 0) return -1;
    kill(process_, SIGTERM);
    int status = -1;
    waitpid(std::exchange(process_, -1), &status, 0);
    return status;
  }

 private:
  TemporaryFolder folder_;
  pid_t process_ = -1;
};

spm::Result<std::unique_ptr<Supervisor>> start_at(const std::string& path) {
  const Supervisor::StartAgain start = start_outside(path, nullptr);
  return Supervisor::start_by(start, start);
}

/// A daemon in a group of its own that asks for a supervisor, ticks until it is told to, and waits.
pid_t daemon_at(const std::string& path, bool says_good_bye) {
  const pid_t process = fork();
  if (process != 0) return process;
  setpgid(0, 0);
  auto supervisor = start_at(path);
  if (!supervisor || !(*supervisor)->watch({"one"})) _exit(1);
  for (int tick = 0; tick < 50 || !says_good_bye; ++tick) {
    (*supervisor)->beat().store(now_ns());
    usleep(1000);
  }
  supervisor->reset();
  _exit(0);
}

bool is_zeroed(const Outside& outside) {
  return eventually(
      [&] { return content(outside.log()).find("zero to one") != std::string::npos; });
}

}  // namespace

TEST_CASE("A daemon that is paused with all its processes has its devices sent zero from outside") {
  Outside outside;
  REQUIRE(outside.listens());
  const pid_t daemon = daemon_at(outside.path(), false);
  REQUIRE(eventually([&] { return outside.told().find("has a supervisor") != std::string::npos; }));
  usleep(100'000);
  CHECK(content(outside.log()).empty());
  SECTION("paused, and going on") {
    kill(-daemon, SIGSTOP);
    CHECK(is_zeroed(outside));
    kill(-daemon, SIGCONT);
  }
  SECTION("killed") {
    kill(-daemon, SIGKILL);
    CHECK(is_zeroed(outside));
  }
  SECTION("killed after the program that makes supervisors has ended") {
    CHECK(outside.end() == 0);
    kill(-daemon, SIGKILL);
    CHECK(is_zeroed(outside));
  }
  kill(-daemon, SIGKILL);
  waitpid(daemon, nullptr, 0);
}

TEST_CASE("A daemon that ends as it should leaves its outside supervisor nothing to do") {
  Outside outside;
  REQUIRE(outside.listens());
  const pid_t daemon = daemon_at(outside.path(), true);
  int status = -1;
  REQUIRE(waitpid(daemon, &status, 0) == daemon);
  CHECK(status == 0);
  usleep(100'000);
  CHECK(content(outside.log()).empty());
}

TEST_CASE("An outside supervisor's end is noticed, and another one is asked for") {
  Outside outside;
  REQUIRE(outside.listens());
  auto supervisor = start_at(outside.path());
  REQUIRE(supervisor);
  REQUIRE((*supervisor)->watch({"one"}));
  const std::string told = outside.told();
  const std::string before = "has a supervisor (process ";
  REQUIRE(eventually([&] { return outside.told().find(before) != std::string::npos; }));
  const std::string text = outside.told();
  const pid_t process = std::stoi(text.substr(text.rfind(before) + before.size()));
  std::array<int, 2> never{};
  REQUIRE(pipe(never.data()) == 0);
  REQUIRE(kill(process, SIGKILL) == 0);
  REQUIRE((*supervisor)->await_end(never[0]));
  REQUIRE((*supervisor)->replace());
  (*supervisor)->beat().store(now_ns());
  CHECK(is_zeroed(outside));
  (*supervisor)->beat().store(0);
  close(never[0]);
  close(never[1]);
}

TEST_CASE("Where nobody listens a daemon is told what to start") {
  const TemporaryFolder folder;
  const auto there = check_outside_supervisor(folder.file("none.sock"));
  REQUIRE_FALSE(there);
  CHECK(there.error().code == spm::ExitCode::file_or_device);
  CHECK(there.error().message.find("start 'spm-servo supervise --socket PATH'") !=
        std::string::npos);
}

TEST_CASE("What is no daemon's request gets no supervisor, and ends nothing") {
  Outside outside;
  REQUIRE(outside.listens());
  // It connects and says nothing, as a program that looks whether somebody is there.
  for (int i = 0; i < 3; ++i) REQUIRE(check_outside_supervisor(outside.path()));
  auto supervisor = start_at(outside.path());
  CHECK(supervisor.has_value());
}

}  // namespace outside_supervisor_test
