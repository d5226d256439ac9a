// SPDX-License-Identifier: Apache-2.0
#include "servo/realtime/sleep_notice.hpp"

#include <fcntl.h>
#include <systemd/sd-bus.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <functional>
#include <string>

#include "tests/servo/support/private_bus.hpp"

namespace sleep_notice_test {

using namespace spm::servo;

namespace {

/// The part of logind that programs ask to wait, which notes for whom it waits.
struct FakeLogind {
  sd_bus* bus = nullptr;
  int asked = 0;
  std::string what, mode;
  int held = -1;  ///< reads the end once the program lets go

  FakeLogind() {
    REQUIRE(sd_bus_open_system(&bus) >= 0);
    REQUIRE(sd_bus_add_object(bus, nullptr, "/org/freedesktop/login1", &FakeLogind::answer, this) >=
            0);
    REQUIRE(sd_bus_request_name(bus, "org.freedesktop.login1", 0) >= 0);
  }
  FakeLogind(const FakeLogind&) = delete;
  FakeLogind& operator=(const FakeLogind&) = delete;
  ~FakeLogind() {
    if (held >= 0) close(held);
    sd_bus_flush_close_unref(bus);
  }

  static int answer(sd_bus_message* message, void* self, sd_bus_error*) {
    auto* logind = static_cast<FakeLogind*>(self);
    if (sd_bus_message_is_method_call(message, "org.freedesktop.login1.Manager", "Inhibit") <= 0) {
      return 0;
    }
    const char *what = "", *who = "", *why = "", *mode = "";
    if (sd_bus_message_read(message, "ssss", &what, &who, &why, &mode) < 0) return 0;
    ++logind->asked;
    logind->what = what;
    logind->mode = mode;
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC | O_NONBLOCK) != 0) return 0;
    if (logind->held >= 0) close(logind->held);
    logind->held = ends[0];
    const int code = sd_bus_reply_method_return(message, "h", ends[1]);
    close(ends[1]);
    return code;
  }
  void tell(bool begins) const {
    REQUIRE(sd_bus_emit_signal(bus, "/org/freedesktop/login1", "org.freedesktop.login1.Manager",
                               "PrepareForSleep", "b", begins ? 1 : 0) >= 0);
  }
  /// Whether the program still makes the machine wait.
  [[nodiscard]] bool waits() const {
    char byte = 0;
    return read(held, &byte, 1) < 0;
  }
  /// Serves the bus until something holds; false if it does not within some seconds.
  [[nodiscard]] bool comes(const std::function<bool()>& holds) const {
    for (int round = 0; round < 2000; ++round) {
      while (sd_bus_process(bus, nullptr) > 0) {
      }
      if (holds()) return true;
      sd_bus_wait(bus, 10'000);
    }
    return false;
  }
};

}  // namespace

TEST_CASE("A machine that goes to sleep waits until the force is off, and is told awake again") {
  const spm::test::PrivateBus private_bus;
  FakeLogind logind;
  const SleepNotice notice;
  REQUIRE(logind.comes([&] { return logind.asked == 1; }));
  CHECK(logind.what == "sleep");
  CHECK(logind.mode == "delay");
  CHECK(logind.waits());
  CHECK_FALSE(notice.sleeping().load());
  logind.tell(true);
  REQUIRE(logind.comes([&] { return notice.sleeping().load(); }));
  REQUIRE(logind.comes([&] { return !logind.waits(); }));
  CHECK(notice.sleeping().load());
  logind.tell(false);
  REQUIRE(logind.comes([&] { return logind.asked == 2; }));
  CHECK_FALSE(notice.sleeping().load());
  CHECK(logind.waits());
}

TEST_CASE("Without a system bus or logind nothing sleeps, and nothing waits") {
  setenv("DBUS_SYSTEM_BUS_ADDRESS", "unix:path=/nonexistent/bus", 1);
  { CHECK_FALSE(SleepNotice().sleeping().load()); }
  const spm::test::PrivateBus private_bus;
  CHECK_FALSE(SleepNotice().sleeping().load());
}

}  // namespace sleep_notice_test
