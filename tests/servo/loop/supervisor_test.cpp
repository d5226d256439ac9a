// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/supervisor.hpp"

#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <csignal>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "servo/base/clock.hpp"
#include "servo/devices/finder/device_list.hpp"
#include "servo/loop/supervisor_process.hpp"
#include "tests/servo/support/eventually.hpp"
#include "tests/servo/support/log_file.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace supervisor_test {

using namespace spm::servo;
using spm::test::append;
using spm::test::content;
using spm::test::eventually;
using spm::test::TemporaryFolder;

namespace {

/// The only child of a process; 0 if there is none.
pid_t only_child_of(pid_t process) {
  const std::string id = std::to_string(process);
  std::ifstream file("/proc/" + id + "/task/" + id + "/children");
  pid_t child = 0;
  return file >> child ? child : 0;
}

std::size_t count_of(const std::string& text, const std::string& line) {
  std::size_t count = 0;
  for (std::size_t at = text.find(line); at != std::string::npos; at = text.find(line, at + 1)) {
    ++count;
  }
  return count;
}

/// Reads everything until nobody can write any longer.
std::string read_all(int file) {
  std::string text;
  std::array<char, 256> part{};
  for (ssize_t size = 1; size > 0;) {
    size = read(file, part.data(), part.size());
    if (size > 0) text.append(part.data(), static_cast<std::size_t>(size));
  }
  return text;
}

/// Devices that write down, in a file, what a supervisor does to them.
Supervisor::Open logged_devices(const std::string& log) {
  return [log](const std::string& target) -> spm::Result<ZeroForce> {
    append(log, "open " + target);
    return ZeroForce([log, target] {
      append(log, "zero to " + target);
      return true;
    });
  };
}

/// A daemon that starts a supervisor, drives devices, and then does what `end` says. Its standard
/// error is a pipe, which its supervisor holds too: it ends when both have.
class StandIn {
 public:
  StandIn(const Supervisor::Open& open, const std::vector<std::string>& targets,
          const std::function<void()>& before, const std::function<void()>& end) {
    std::array<int, 2> error{}, ready{};
    REQUIRE(pipe(error.data()) == 0);
    REQUIRE(pipe(ready.data()) == 0);
    process_ = fork();
    if (process_ == 0) {
      dup2(error[1], STDERR_FILENO);
      // In a group of its own, as a shell gives one to each command.
      setpgid(0, 0);
      die_as_others_do();
      before();
      _exit(drive(open, targets, end, ready[1]));
    }
    close(error[1]);
    close(ready[1]);
    error_ = error[0];
    ready_ = ready[0];
  }
  StandIn(const StandIn&) = delete;
  StandIn& operator=(const StandIn&) = delete;
  ~StandIn() {
    close(error_);
    close(ready_);
  }

  /// Waits until it drives its devices.
  void await() const {
    char byte = 0;
    REQUIRE(read(ready_, &byte, 1) == 1);
  }
  [[nodiscard]] pid_t process() const { return process_; }
  /// Its only child.
  [[nodiscard]] pid_t supervisor() const { return only_child_of(process_); }
  /// How it ended, as waitpid tells it.
  [[nodiscard]] int status() const {
    int status = 0;
    REQUIRE(waitpid(process_, &status, 0) == process_);
    return status;
  }
  /// What it and its supervisor said, once both have ended.
  [[nodiscard]] std::string said() const { return read_all(error_); }
  /// Ends once nobody holds the daemon's files.
  [[nodiscard]] int ready() const { return ready_; }

 private:
  /// Makes a crash end the process without the tests' handler and without a core file.
  static void die_as_others_do() {
    std::signal(SIGSEGV, SIG_DFL);
    const rlimit none{};
    setrlimit(RLIMIT_CORE, &none);
  }

  static int drive(const Supervisor::Open& open, const std::vector<std::string>& targets,
                   const std::function<void()>& end, int ready) {
    auto supervisor = Supervisor::start(open);
    if (!supervisor || !(*supervisor)->watch(targets)) return 1;
    static_cast<void>(!write(ready, "x", 1));
    end();
    return 0;
  }

  pid_t process_ = -1;
  int error_ = -1, ready_ = -1;
};

const auto nothing = [] {};
const auto wait_for_a_signal = [] {
  while (true) pause();
};

}  // namespace

TEST_CASE("Where the daemon is killed each of its devices is sent zero force, and that is said") {
  const TemporaryFolder folder;
  const std::string log = folder.file("log");
  const StandIn daemon(logged_devices(log), {"one", "", "two"}, nothing, wait_for_a_signal);
  daemon.await();
  REQUIRE(content(log).empty());
  SECTION("by itself") { kill(daemon.process(), SIGKILL); }
  SECTION("with its whole group") { kill(-daemon.process(), SIGKILL); }
  SECTION("as a crash ends it") { kill(daemon.process(), SIGSEGV); }
  REQUIRE(WIFSIGNALED(daemon.status()));
  REQUIRE(daemon.said() ==
          "error: spm-servo ended without a good-bye, killed or crashed: zero force was sent to "
          "one and two\n");
  const std::string seen = content(log);
  for (const char* name : {"one", "two"}) {
    REQUIRE(count_of(seen, std::string("open ") + name) == 1);
    REQUIRE(count_of(seen, std::string("zero to ") + name) >= 3);
  }
  // The first zero waits for no other device.
  REQUIRE(seen.starts_with("open one\nzero to one\nopen two\nzero to two\n"));
}

TEST_CASE("After a good-bye nothing is sent, and nothing said") {
  const TemporaryFolder folder;
  const std::string log = folder.file("log");
  const StandIn daemon(logged_devices(log), {"one"}, nothing, nothing);
  REQUIRE(daemon.status() == 0);
  REQUIRE(daemon.said().empty());
  REQUIRE(content(log).empty());
}

TEST_CASE("A daemon that is killed before it drives a device leaves nothing to do") {
  const TemporaryFolder folder;
  const std::string log = folder.file("log");
  const StandIn daemon(logged_devices(log), {}, nothing, wait_for_a_signal);
  daemon.await();
  kill(daemon.process(), SIGKILL);
  REQUIRE(WIFSIGNALED(daemon.status()));
  REQUIRE(daemon.said().empty());
  REQUIRE(content(log).empty());
}

TEST_CASE("A device that cannot be opened at once is tried again, beside one that can") {
  const TemporaryFolder folder;
  const std::string log = folder.file("log");
  const auto open = [log, refusals = 3](const std::string& target) mutable {
    if (target == "late" && refusals-- > 0) {
      append(log, "refused");
      return spm::Result<ZeroForce>(spm::fail(spm::ExitCode::file_or_device, "in use"));
    }
    return logged_devices(log)(target);
  };
  const StandIn daemon(open, {"late", "ready"}, nothing, wait_for_a_signal);
  daemon.await();
  kill(daemon.process(), SIGKILL);
  REQUIRE(WIFSIGNALED(daemon.status()));
  REQUIRE(daemon.said().ends_with("zero force was sent to late and ready\n"));
  const std::string seen = content(log);
  REQUIRE(count_of(seen, "refused") == 3);
  REQUIRE(seen.find("zero to ready") < seen.find("zero to late"));
}

TEST_CASE("A device that is lost meanwhile is opened and sent zero force again") {
  const TemporaryFolder folder;
  const std::string log = folder.file("log");
  const auto open = [log, losses = 1](const std::string& target) mutable {
    if (losses-- == 0) return logged_devices(log)(target);
    return spm::Result<ZeroForce>(ZeroForce([log] {
      append(log, "lost");
      return false;
    }));
  };
  const StandIn daemon(open, {"one"}, nothing, wait_for_a_signal);
  daemon.await();
  kill(daemon.process(), SIGKILL);
  REQUIRE(WIFSIGNALED(daemon.status()));
  REQUIRE(daemon.said().ends_with("zero force was sent to one\n"));
  REQUIRE(content(log).starts_with("lost\nopen one\nzero to one\n"));
}

TEST_CASE("A device that stays closed is named with the reason and what to do") {
  const TemporaryFolder folder;
  const std::string log = folder.file("log");
  const auto open = [log](const std::string& target) {
    if (target == "one") return logged_devices(log)(target);
    return spm::Result<ZeroForce>(spm::fail(spm::ExitCode::file_or_device, "unplugged"));
  };
  const StandIn daemon(open, {"one", "two"}, nothing, wait_for_a_signal);
  daemon.await();
  kill(daemon.process(), SIGKILL);
  REQUIRE(WIFSIGNALED(daemon.status()));
  REQUIRE(
      daemon.said() ==
      "error: spm-servo ended without a good-bye, killed or crashed: zero force was sent to one, "
      "but no zero force could be sent to two (unplugged): let go of it and switch it off\n");
}

TEST_CASE("The supervisor keeps no file, priority or locked memory of the daemon's") {
  const TemporaryFolder folder;
  const std::string log = folder.file("log"), gate = folder.file("gate");
  const auto open = [log, gate](const std::string& target) {
    while (content(gate).empty()) usleep(1000);
    std::array<char, 16> name{};
    prctl(PR_GET_NAME, name.data());
    append(log, name.data());
    append(log, "policy " + std::to_string(sched_getscheduler(0)));
    const std::string status = content("/proc/self/status");
    append(log,
           status.substr(status.find("VmLck:"), status.find("VmPin:") - status.find("VmLck:")));
    return logged_devices(log)(target);
  };
  // Takes real-time priority if allowed, like a daemon that was started by chrt.
  const auto be_real_time = [] {
    sched_param priority{};
    priority.sched_priority = 10;
    static_cast<void>(sched_setscheduler(0, SCHED_FIFO, &priority));
    static_cast<void>(mlockall(MCL_CURRENT | MCL_FUTURE));
  };
  const StandIn daemon(open, {"one"}, be_real_time, wait_for_a_signal);
  daemon.await();
  kill(daemon.process(), SIGKILL);
  REQUIRE(WIFSIGNALED(daemon.status()));
  // The supervisor still waits at the gate. If it held the daemon's files, this read would not end.
  REQUIRE(read_all(daemon.ready()).empty());
  append(gate, "open");
  REQUIRE(daemon.said().ends_with("zero force was sent to one\n"));
  const std::string seen = content(log);
  REQUIRE(seen.starts_with("spm-supervisor\npolicy 0\nVmLck:"));
  REQUIRE(seen.find(" 0 kB\n") != std::string::npos);
}

TEST_CASE("A device whose force ends by itself, or that gives none, needs no zero force") {
  for (const char* name : {"sim", "spacemouse", "external:name=test"}) {
    const auto device = make_device(name);
    REQUIRE(device);
    REQUIRE(zero_force_target(**device).empty());
    REQUIRE(open_zero_force(name).error().code == spm::ExitCode::usage);
  }
}

TEST_CASE("Signals that end the daemon do not end the supervisor before it") {
  const TemporaryFolder folder;
  const std::string log = folder.file("log");
  const StandIn daemon(logged_devices(log), {"one"}, nothing, wait_for_a_signal);
  daemon.await();
  const pid_t supervisor = daemon.supervisor();
  REQUIRE(supervisor > 0);
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT})
    REQUIRE(kill(supervisor, number) == 0);
  kill(daemon.process(), SIGKILL);
  REQUIRE(WIFSIGNALED(daemon.status()));
  REQUIRE(daemon.said().ends_with("zero force was sent to one\n"));
}

TEST_CASE("Where the loop stands still its devices are sent zero, and left to it when it goes on") {
  const TemporaryFolder folder;
  const std::string log = folder.file("log");
  auto supervisor = Supervisor::start([log](const std::string& target) {
    // Closed with the last copy of what sends zero to it.
    const std::shared_ptr<void> device(nullptr,
                                       [log, target](void*) { append(log, "close " + target); });
    return logged_devices(log)(target).map(
        [&device](const ZeroForce& zero) { return ZeroForce([zero, device] { return zero(); }); });
  });
  REQUIRE(supervisor);
  REQUIRE((*supervisor)->watch({"one", "two"}));
  std::atomic<std::int64_t>& beat = (*supervisor)->beat();
  const auto stand_still = [&](std::size_t times) {
    beat.store(now_ns());
    REQUIRE(eventually([&] { return count_of(content(log), "zero to two") == 6 * times; }));
    REQUIRE(count_of(content(log), "open one\n") == times);
    REQUIRE(count_of(content(log), "zero to one\n") == 6 * times);
  };
  // Before the first tick, and while the loop ticks, nothing is sent.
  usleep(100'000);
  REQUIRE(content(log).empty());
  stand_still(1);
  beat.store(0);
  REQUIRE(eventually([&] { return count_of(content(log), "close two\n") == 1; }));
  stand_still(2);
  // A loop that has ended does not stand still.
  beat.store(0);
  usleep(100'000);
  REQUIRE(count_of(content(log), "zero to one\n") == 12);
}

TEST_CASE("A device that was found at another place is looked for there") {
  const TemporaryFolder folder;
  const std::string log = folder.file("log");
  auto supervisor = Supervisor::start(logged_devices(log));
  REQUIRE(supervisor);
  REQUIRE((*supervisor)->watch({"old place"}));
  REQUIRE((*supervisor)->watch({"new place"}));
  (*supervisor)->beat().store(now_ns());
  REQUIRE(eventually([&] { return count_of(content(log), "zero to new place") == 6; }));
  REQUIRE(count_of(content(log), "old") == 0);
  SECTION("also while the loop stands still") {
    REQUIRE((*supervisor)->watch({"newest"}));
    REQUIRE(eventually([&] { return count_of(content(log), "zero to newest") == 6; }));
  }
}

TEST_CASE("A daemon outlives its supervisor, and is told of that when it names a device") {
  auto supervisor = Supervisor::start(logged_devices("/dev/null"));
  REQUIRE(supervisor);
  const pid_t process = only_child_of(getpid());
  REQUIRE(process > 0);
  kill(process, SIGKILL);
  siginfo_t ended{};
  REQUIRE(waitid(P_PID, static_cast<id_t>(process), &ended, WEXITED | WNOWAIT) == 0);
  const auto watched = (*supervisor)->watch({"one"});
  REQUIRE(!watched);
  REQUIRE(watched.error().message.find("has ended") != std::string::npos);
}

TEST_CASE("A supervisor that was killed is noticed, and the next one knows the devices") {
  const TemporaryFolder folder;
  const std::string log = folder.file("log");
  const auto open = logged_devices(log);
  auto supervisor = Supervisor::start(open, RealtimeMode::off, {}, [&open](int line, int beat) {
    const pid_t process = fork();
    if (process == 0) {
      supervise(line, *map_beat(beat), open, RealtimeMode::off, {});
      _exit(0);
    }
    return process;
  });
  REQUIRE(supervisor);
  REQUIRE((*supervisor)->watch({"one"}));
  std::array<int, 2> never{};
  REQUIRE(pipe(never.data()) == 0);
  for (std::size_t times = 1; times <= 2; ++times) {
    const pid_t killed = only_child_of(getpid());
    REQUIRE(killed > 0);
    kill(killed, SIGKILL);
    REQUIRE((*supervisor)->await_end(never[0]));
    REQUIRE((*supervisor)->replace());
    // The dead one was waited for.
    CHECK(waitpid(killed, nullptr, WNOHANG) < 0);
    const pid_t next = only_child_of(getpid());
    CHECK(next > 0);
    CHECK(next != killed);
    // There is nothing to replace now.
    REQUIRE((*supervisor)->replace());
    CHECK(only_child_of(getpid()) == next);
    (*supervisor)->beat().store(now_ns());
    REQUIRE(eventually([&] { return count_of(content(log), "zero to one\n") == 6 * times; }));
    (*supervisor)->beat().store(0);
  }
  REQUIRE(write(never[1], "x", 1) == 1);
  CHECK_FALSE((*supervisor)->await_end(never[0]));
  close(never[0]);
  close(never[1]);
}

}  // namespace supervisor_test
