// SPDX-License-Identifier: Apache-2.0

// Answers each report of a WoodenHaptics at once, without a loop. This shows how long a round trip
// over hidapi takes by itself. The answer has a current where the third counter is positive, and
// none elsewhere.
//
// Usage: ping_hid OPTIONS, those of --device woodenhaptics. SIGTERM ends it. If the device does not
// open, it prints a message and exits with code 2.

#include <atomic>
#include <csignal>
#include <cstdio>
#include <string>

#include "servo/devices/wooden/wooden_port.hpp"
#include "servo/realtime/realtime.hpp"

namespace {

using namespace spm::servo;

constexpr std::int16_t current = 100;  // mA

volatile std::sig_atomic_t told_to_end = 0;

bool answer_all(WoodenPort& port) {
  WoodenReport report;
  while (told_to_end == 0) {
    switch (port.receive(report)) {
      case Received::report: {
        WoodenCommand command;
        command.currents[2] = report.counters[2] > 0 ? current : std::int16_t{0};
        if (!port.send(command)) return false;
        break;
      }
      case Received::nothing:
        break;
      case Received::gone:
        return false;
    }
  }
  return port.send(WoodenCommand{});
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s OPTIONS\n", argv[0]);
    return 1;
  }
  std::signal(SIGTERM, [](int) { told_to_end = 1; });
  const auto options = parse_wooden_options(argv[1]);
  if (!options) {
    std::fprintf(stderr, "ping_hid: %s\n", options.error().message.c_str());
    return static_cast<int>(options.error().code);
  }
  enter_device_thread(RealtimeMode::attempt);
  const std::atomic<bool> stop{false};
  const auto port = WoodenPort::open(*options, 1, stop);
  if (!port) {
    std::fprintf(stderr, "ping_hid: %s\n", port.error().message.c_str());
    return static_cast<int>(port.error().code);
  }
  return answer_all(**port) ? 0 : 4;
}
