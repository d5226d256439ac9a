// SPDX-License-Identifier: Apache-2.0
#include "servo/realtime/own_scope.hpp"

#include <systemd/sd-bus.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>

namespace spm::servo {

namespace {

constexpr std::uint64_t scope_timeout_us = 1'000'000;

bool ask_for_scope(int (*open)(sd_bus**), const std::string& scope) {
  sd_bus* bus = nullptr;
  if (open(&bus) < 0) return false;
  sd_bus_set_method_call_timeout(bus, scope_timeout_us);
  const int code = sd_bus_call_method(bus, "org.freedesktop.systemd1", "/org/freedesktop/systemd1",
                                      "org.freedesktop.systemd1.Manager", "StartTransientUnit",
                                      nullptr, nullptr, "ssa(sv)a(sa(sv))", scope.c_str(), "fail",
                                      2, "PIDs", "au", 1, static_cast<std::uint32_t>(getpid()),
                                      "CollectMode", "s", "inactive-or-failed", 0);
  sd_bus_flush_close_unref(bus);
  return code >= 0;
}

}  // namespace

bool is_service() { return std::getenv("INVOCATION_ID") != nullptr; }

bool enter_own_scope(const std::string& name) {
  const std::string scope = name + "-" + std::to_string(getpid()) + ".scope";
  return ask_for_scope(sd_bus_open_user, scope) || ask_for_scope(sd_bus_open_system, scope);
}

}  // namespace spm::servo
