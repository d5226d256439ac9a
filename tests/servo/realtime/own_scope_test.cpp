// SPDX-License-Identifier: Apache-2.0
#include "servo/realtime/own_scope.hpp"

#include <sys/wait.h>
#include <systemd/sd-bus.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "tests/servo/support/private_bus.hpp"

namespace own_scope_test {

using namespace spm::servo;

namespace {

/// The part of a service manager that makes scopes, which only notes what it was asked.
struct FakeManager {
  std::string scope, mode;
  std::uint32_t process = 0;

  static int answer(sd_bus_message* message, void* self, sd_bus_error*) {
    auto* manager = static_cast<FakeManager*>(self);
    if (sd_bus_message_is_method_call(message, "org.freedesktop.systemd1.Manager",
                                      "StartTransientUnit") <= 0) {
      return 0;
    }
    const char *scope = "", *mode = "", *key = "";
    if (sd_bus_message_read(message, "ss", &scope, &mode) < 0) return 0;
    manager->scope = scope;
    manager->mode = mode;
    if (sd_bus_message_enter_container(message, 'a', "(sv)") < 0 ||
        sd_bus_message_enter_container(message, 'r', "sv") < 0 ||
        sd_bus_message_read(message, "s", &key) < 0 || std::string(key) != "PIDs" ||
        sd_bus_message_read(message, "v", "au", 1, &manager->process) < 0) {
      return 0;
    }
    return sd_bus_reply_method_return(message, "o", "/org/freedesktop/systemd1/job/1");
  }
};

/// Runs `enter_own_scope` in a process of its own; whether it was done.
bool entered(sd_bus* bus, pid_t& process) {
  process = fork();
  if (process == 0) _exit(enter_own_scope("spm-supervisor") ? 0 : 1);
  int status = 0;
  while (waitpid(process, &status, WNOHANG) == 0) {
    while (sd_bus_process(bus, nullptr) > 0) {
    }
    sd_bus_wait(bus, 5000);
  }
  return status == 0;
}

}  // namespace

TEST_CASE("The user's manager is asked for a scope with this process alone, or else the system's") {
  const char* variable = GENERATE("DBUS_SESSION_BUS_ADDRESS", "DBUS_SYSTEM_BUS_ADDRESS");
  setenv("DBUS_SESSION_BUS_ADDRESS", "unix:path=/nonexistent/bus", 1);
  setenv("DBUS_SYSTEM_BUS_ADDRESS", "unix:path=/nonexistent/bus", 1);
  const spm::test::PrivateBus private_bus(variable);
  sd_bus* bus = nullptr;
  REQUIRE((variable == std::string("DBUS_SYSTEM_BUS_ADDRESS") ? sd_bus_open_system(&bus)
                                                              : sd_bus_open_user(&bus)) >= 0);
  FakeManager manager;
  REQUIRE(sd_bus_add_object(bus, nullptr, "/org/freedesktop/systemd1", &FakeManager::answer,
                            &manager) >= 0);
  pid_t process = 0;
  // Nobody has the manager's name yet.
  REQUIRE_FALSE(entered(bus, process));
  REQUIRE(sd_bus_request_name(bus, "org.freedesktop.systemd1", 0) >= 0);
  REQUIRE(entered(bus, process));
  CHECK(manager.scope == "spm-supervisor-" + std::to_string(process) + ".scope");
  CHECK(manager.mode == "fail");
  CHECK(manager.process == static_cast<std::uint32_t>(process));
  sd_bus_flush_close_unref(bus);
  unsetenv("DBUS_SESSION_BUS_ADDRESS");
}

}  // namespace own_scope_test
