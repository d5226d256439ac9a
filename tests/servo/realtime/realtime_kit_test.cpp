// SPDX-License-Identifier: Apache-2.0
#include "servo/realtime/realtime_kit.hpp"

#include <linux/capability.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <systemd/sd-bus.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "servo/realtime/realtime.hpp"
#include "tests/servo/support/private_bus.hpp"

namespace realtime_kit_test {

using namespace spm::servo;
using spm::test::PrivateBus;

namespace {

constexpr const char* name = "org.freedesktop.RealtimeKit1";
constexpr const char* object = "/org/freedesktop/RealtimeKit1";

struct Asked {
  std::uint64_t process = 0, thread = 0;
  std::uint32_t priority = 0;
  rlim_t time_limit = 0;  ///< us, the hard limit that the process had then
};

/// RealtimeKit as its interface describes it, which gives no priority but notes who asked.
class FakeKit {
 public:
  explicit FakeKit(std::string refusal = "") : refusal_(std::move(refusal)) {
    REQUIRE(sd_bus_open_system(&bus_) >= 0);
    REQUIRE(sd_bus_add_object(bus_, nullptr, object, &FakeKit::answer, this) >= 0);
    REQUIRE(sd_bus_request_name(bus_, name, 0) >= 0);
  }
  FakeKit(const FakeKit&) = delete;
  FakeKit& operator=(const FakeKit&) = delete;
  ~FakeKit() { sd_bus_flush_close_unref(bus_); }

  /// Answers while a child process runs `ask`; gives what that wrote.
  std::string beside(const std::function<std::string()>& ask) {
    std::array<int, 2> told{};
    REQUIRE(pipe(told.data()) == 0);
    child_ = fork();
    if (child_ == 0) {
      const std::string text = ask();
      _exit(write(told[1], text.data(), text.size()) == static_cast<ssize_t>(text.size()) ? 0 : 1);
    }
    close(told[1]);
    int status = 0;
    while (waitpid(child_, &status, WNOHANG) == 0) {
      while (sd_bus_process(bus_, nullptr) > 0) {
      }
      sd_bus_wait(bus_, 5000);
    }
    REQUIRE(status == 0);
    std::array<char, 2048> text{};
    const ssize_t size = read(told[0], text.data(), text.size());
    close(told[0]);
    return {text.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0))};
  }

  [[nodiscard]] const std::vector<Asked>& asked() const { return asked_; }
  [[nodiscard]] pid_t child() const { return child_; }

  static constexpr std::int32_t max_priority = 17;
  static constexpr std::int64_t max_time_us = 150'000;

 private:
  static int answer(sd_bus_message* message, void* self, sd_bus_error*) {
    auto* kit = static_cast<FakeKit*>(self);
    if (sd_bus_message_is_method_call(message, "org.freedesktop.DBus.Properties", "Get") > 0) {
      const char *of = "", *which = "";
      if (sd_bus_message_read(message, "ss", &of, &which) < 0) return 0;
      if (std::strcmp(of, name) != 0) return 0;
      if (std::strcmp(which, "MaxRealtimePriority") == 0) {
        return sd_bus_reply_method_return(message, "v", "i", max_priority);
      }
      if (std::strcmp(which, "RTTimeUSecMax") == 0) {
        return sd_bus_reply_method_return(message, "v", "x", max_time_us);
      }
      return 0;
    }
    if (sd_bus_message_is_method_call(message, name, "MakeThreadRealtimeWithPID") <= 0) return 0;
    if (!kit->refusal_.empty()) {
      return sd_bus_reply_method_errorf(message, "org.freedesktop.DBus.Error.AccessDenied", "%s",
                                        kit->refusal_.c_str());
    }
    Asked asked;
    if (sd_bus_message_read(message, "ttu", &asked.process, &asked.thread, &asked.priority) < 0) {
      return 0;
    }
    rlimit limit{};
    prlimit(static_cast<pid_t>(asked.process), RLIMIT_RTTIME, nullptr, &limit);
    asked.time_limit = limit.rlim_max;
    kit->asked_.push_back(asked);
    return sd_bus_reply_method_return(message, "");
  }

  sd_bus* bus_ = nullptr;
  std::string refusal_;
  std::vector<Asked> asked_;
  pid_t child_ = -1;
};

std::string text_of(const spm::Result<int>& given) {
  return given ? std::to_string(*given) : given.error().message;
}

std::string text_of(const spm::Result<RealtimeState>& state) {
  if (!state) return state.error().message;
  std::string text = state->policy + " " + std::to_string(state->priority);
  for (const std::string& warning : state->warnings) text += "\n" + warning;
  return text;
}

/// Makes the process one that may not take real-time priority by itself.
void give_up_priority() {
  const rlimit none{};
  setrlimit(RLIMIT_RTPRIO, &none);
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  std::array<__user_cap_data_struct, 2> sets{};
  syscall(SYS_capget, &header, sets.data());
  sets[0].effective &= ~(1U << CAP_SYS_NICE);
  syscall(SYS_capset, &header, sets.data());
}

}  // namespace

TEST_CASE("RealtimeKit is asked for the calling thread, below the most that it gives") {
  const PrivateBus bus;
  FakeKit kit;
  const std::string told = kit.beside([] {
    std::string text;
    std::thread([&text] {
      text = text_of(ask_realtime_kit(2)) + " " + std::to_string(gettid());
    }).join();
    return text;
  });
  REQUIRE(kit.asked().size() == 1);
  const Asked& asked = kit.asked().front();
  REQUIRE(asked.process == static_cast<std::uint64_t>(kit.child()));
  REQUIRE(asked.thread != asked.process);
  REQUIRE(asked.priority == FakeKit::max_priority - 2);
  REQUIRE(asked.time_limit == FakeKit::max_time_us);
  REQUIRE(told == "15 " + std::to_string(asked.thread));
}

TEST_CASE("RealtimeKit is never asked for less than the lowest priority") {
  const PrivateBus bus;
  FakeKit kit;
  REQUIRE(kit.beside([] { return text_of(ask_realtime_kit(100)); }) == "1");
  REQUIRE(kit.asked().front().priority == 1);
}

TEST_CASE("A lower limit of computing time that a process has stays") {
  const PrivateBus bus;
  FakeKit kit;
  const std::string told = kit.beside([] {
    const rlimit limit{50'000, 100'000};
    setrlimit(RLIMIT_RTTIME, &limit);
    std::string text = text_of(ask_realtime_kit(0));
    rlimit left{};
    getrlimit(RLIMIT_RTTIME, &left);
    return text + " " + std::to_string(left.rlim_cur) + " " + std::to_string(left.rlim_max);
  });
  REQUIRE(told == "17 50000 100000");
}

TEST_CASE("What RealtimeKit refuses is told in its words") {
  const PrivateBus bus;
  FakeKit kit("you have too many already");
  const std::string told = kit.beside([] { return text_of(ask_realtime_kit(0)); });
  REQUIRE(told == "RealtimeKit gives none: you have too many already");
}

TEST_CASE("Without RealtimeKit or without a bus the refusal says so, and no limit is set") {
  std::string told;
  const auto ask = [] {
    std::string text = text_of(ask_realtime_kit(0));
    rlimit left{};
    getrlimit(RLIMIT_RTTIME, &left);
    return text + (left.rlim_max == RLIM_INFINITY ? ", unlimited" : ", limited");
  };
  const PrivateBus bus;
  SECTION("no such service") {
    FakeKit kit;
    // Ask on another bus, where nobody owns the name.
    const PrivateBus empty;
    told = kit.beside(ask);
  }
  SECTION("no bus") {
    FakeKit kit;
    setenv("DBUS_SYSTEM_BUS_ADDRESS", "unix:path=/nonexistent/bus", 1);
    told = kit.beside(ask);
  }
  REQUIRE(told.starts_with("RealtimeKit gives none: "));
  REQUIRE(told.ends_with(", unlimited"));
}

TEST_CASE("Where the kernel refuses a loop its priority RealtimeKit is asked, and told of") {
  const PrivateBus bus;
  FakeKit kit;
  const std::string told = kit.beside([] {
    give_up_priority();
    enter_device_thread(RealtimeMode::attempt);
    enter_guard_thread(RealtimeMode::attempt);
    return text_of(enter_realtime(RealtimeMode::attempt));
  });
  REQUIRE(told.starts_with("rtkit " + std::to_string(FakeKit::max_priority - 1)));
  REQUIRE(told.find("no real-time priority") == std::string::npos);
  // The threads of devices stay below the loop, and those above it that end a force.
  REQUIRE(kit.asked().size() == 3);
  REQUIRE(kit.asked()[0].priority == FakeKit::max_priority - 2);
  REQUIRE(kit.asked()[1].priority == FakeKit::max_priority);
  REQUIRE(kit.asked()[2].priority == FakeKit::max_priority - 1);
}

TEST_CASE("Where RealtimeKit refuses too, both reasons are in the warning") {
  const PrivateBus bus;
  FakeKit kit("not you");
  const auto ask = [](RealtimeMode mode) {
    return [mode] {
      give_up_priority();
      return text_of(enter_realtime(mode));
    };
  };
  const std::string warned = kit.beside(ask(RealtimeMode::attempt));
  REQUIRE(warned.starts_with("other 0\n"));
  REQUIRE(warned.find("no real-time priority (Operation not permitted; RealtimeKit gives none: not "
                      "you)") != std::string::npos);
  REQUIRE(kit.beside(ask(RealtimeMode::require)).starts_with("real time was required, but "));
  REQUIRE(kit.beside(ask(RealtimeMode::off)) == "other 0");
}

}  // namespace realtime_kit_test
