// SPDX-License-Identifier: Apache-2.0
#include "servo/realtime/sleep_notice.hpp"

#include <fcntl.h>
#include <systemd/sd-bus.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <memory>

namespace spm::servo {

namespace {

constexpr const char* service = "org.freedesktop.login1";
constexpr const char* path = "/org/freedesktop/login1";
constexpr const char* interface = "org.freedesktop.login1.Manager";
constexpr std::uint64_t look_us = 100'000;
/// Some ticks of any loop, so that each device has heard of no force.
constexpr std::chrono::milliseconds time_to_end{20};

struct CloseBus {
  void operator()(sd_bus* bus) const noexcept { sd_bus_flush_close_unref(bus); }
};

/// What is known of one machine's sleep.
struct Sleep {
  sd_bus* bus;
  std::atomic<bool>& sleeping;
  int inhibitor =
      -1;  ///< while it is open the machine waits; -1: it does not wait for this program

  Sleep(sd_bus* from, std::atomic<bool>& told) noexcept : bus(from), sleeping(told) {}
  Sleep(const Sleep&) = delete;
  Sleep& operator=(const Sleep&) = delete;
  ~Sleep() { let_go(); }

  void let_go() noexcept {
    if (inhibitor >= 0) close(inhibitor);
    inhibitor = -1;
  }
  void hold() noexcept {
    sd_bus_message* reply = nullptr;
    const int code = sd_bus_call_method(bus, service, path, interface, "Inhibit", nullptr, &reply,
                                        "ssss", "sleep", "spm-servo",
                                        "the force of haptic devices is taken away first", "delay");
    int descriptor = -1;
    if (code >= 0 && sd_bus_message_read(reply, "h", &descriptor) >= 0) {
      let_go();
      inhibitor = fcntl(descriptor, F_DUPFD_CLOEXEC, 3);
    }
    sd_bus_message_unref(reply);
  }
  static int prepare(sd_bus_message* message, void* self, sd_bus_error*) {
    auto& sleep = *static_cast<Sleep*>(self);
    int begins = 0;
    if (sd_bus_message_read(message, "b", &begins) < 0) return 0;
    sleep.sleeping.store(begins != 0);
    if (begins == 0) {
      sleep.hold();
      return 0;
    }
    std::this_thread::sleep_for(time_to_end);
    sleep.let_go();
    return 0;
  }
};

}  // namespace

SleepNotice::SleepNotice() : thread_([this] { watch(); }) {}

SleepNotice::~SleepNotice() {
  stop_.store(true);
  thread_.join();
}

void SleepNotice::watch() noexcept {
  sd_bus* opened = nullptr;
  if (sd_bus_open_system(&opened) < 0) return;
  const std::unique_ptr<sd_bus, CloseBus> bus(opened);
  Sleep sleep(bus.get(), sleeping_);
  if (sd_bus_match_signal(bus.get(), nullptr, service, path, interface, "PrepareForSleep",
                          &Sleep::prepare, &sleep) < 0) {
    return;
  }
  sleep.hold();
  while (!stop_.load()) {
    const int done = sd_bus_process(bus.get(), nullptr);
    if (done < 0 || (done == 0 && sd_bus_wait(bus.get(), look_us) < 0)) break;
  }
  // Nobody would tell any more when the machine is awake.
  sleeping_.store(false);
}

}  // namespace spm::servo
