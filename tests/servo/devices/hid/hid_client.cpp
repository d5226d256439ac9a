// SPDX-License-Identifier: Apache-2.0

// Runs a HID device at 1 kHz without a loop around it, pushes the tool to the right with 1 N while
// the device may be pushed, and prints what it saw as JSON.
//
// Usage: hid_client woodenhaptics|spacemouse|pid TICKS OPTIONS, with the options of --device.
// SIGTERM ends it before. Exit code 2, and the sentence, where the device does not open.

#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "servo/base/clock.hpp"
#include "servo/devices/pid/device_pid.hpp"
#include "servo/devices/spacemouse/device_spacemouse.hpp"
#include "servo/devices/wooden/device_wooden.hpp"
#include "servo/realtime/realtime.hpp"

namespace {

using spm::Result;
using spm::Vector3;
using namespace spm::servo;

constexpr std::int64_t period_ns = 1'000'000;
constexpr double push = 1;  // N

volatile std::sig_atomic_t told_to_end = 0;

constexpr std::array<const char*, 6> health_names{"ok",   "fault",     "silent",
                                                  "gone", "not_homed", "unconfirmed"};

/// What the client saw of its device.
struct Seen {
  std::array<std::uint64_t, health_names.size()> reads{}, writes{};
  nlohmann::ordered_json changes = nlohmann::ordered_json::array();
  Vector3 first = Vector3::Zero(), before = Vector3::Zero();
  Vector3 least = Vector3::Constant(1), most = Vector3::Constant(-1);
  double farthest_step = 0;
  std::uint64_t new_positions = 0;
  std::uint32_t buttons = 0;
  bool known = false, was_ok = false;

  void take(const DeviceState& state) {
    if (!known) first = state.position;
    known = true;
    least = least.cwiseMin(state.position);
    most = most.cwiseMax(state.position);
    const double step = (state.position - before).norm();
    if (was_ok) farthest_step = std::max(farthest_step, step);
    new_positions += step > 0 ? 1 : 0;
    before = state.position;
    buttons |= state.buttons;
  }
};

std::array<double, 3> numbers(const Vector3& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

void print(const Seen& seen, const Device& device) {
  nlohmann::ordered_json json{{"name", device.capabilities().name},
                              {"force_cap_N", device.capabilities().force_cap},
                              {"encoder_step_m", device.capabilities().encoder_step}};
  for (std::size_t i = 0; i < health_names.size(); ++i) {
    json["read"][health_names[i]] = seen.reads[i];
    json["write"][health_names[i]] = seen.writes[i];
  }
  json["changes"] = seen.changes;
  json["new_positions"] = seen.new_positions;
  json["first_m"] = numbers(seen.first);
  json["min_m"] = numbers(seen.least);
  json["max_m"] = numbers(seen.most);
  json["farthest_step_m"] = seen.farthest_step;
  json["buttons"] = seen.buttons;
  json["device"] = device.describe();
  fmt::print("{}\n", json.dump(2));
}

int run(Device& device, std::uint64_t ticks) {
  const Result<void> opened = device.open({});
  if (!opened) {
    fmt::print(stderr, "{}\n", opened.error().message);
    return static_cast<int>(opened.error().code);
  }
  static_cast<void>(enter_realtime(RealtimeMode::attempt));
  Seen seen;
  std::size_t last = health_names.size();
  std::int64_t due = now_ns();
  for (std::uint64_t tick = 0; tick < ticks && told_to_end == 0; ++tick) {
    // A tick that comes late is late; none is run twice at once for it.
    due = std::max(due + period_ns, now_ns());
    sleep_until(due);
    DeviceState state;
    const auto health = static_cast<std::size_t>(device.read(state));
    ++seen.reads[health];
    if (health != last) seen.changes.push_back(health_names[health]);
    last = health;
    Wrench wrench;
    const bool is_ok = health == static_cast<std::size_t>(DeviceHealth::ok);
    if (is_ok) {
      seen.take(state);
      wrench.force.x() = push;
    }
    seen.was_ok = is_ok;
    ++seen.writes[static_cast<std::size_t>(device.write(wrench))];
  }
  static_cast<void>(device.write({}));
  print(seen, device);
  return 0;
}

template <class Made, class Options>
int run_with(const Result<Options>& options, std::uint64_t ticks) {
  if (!options) {
    fmt::print(stderr, "{}\n", options.error().message);
    return static_cast<int>(options.error().code);
  }
  Made device(*options);
  return run(device, ticks);
}

}  // namespace

int main(int count, char** arguments) try {
  std::signal(SIGTERM, [](int) { told_to_end = 1; });
  // The standard output is the report's.
  spdlog::set_default_logger(spdlog::stderr_logger_mt("hid_client"));
  const std::string_view name = count == 4 ? arguments[1] : "";
  const std::uint64_t ticks = count == 4 ? std::strtoull(arguments[2], nullptr, 10) : 0;
  if (name == "woodenhaptics") {
    return run_with<DeviceWooden>(parse_wooden_options(arguments[3]), ticks);
  }
  if (name == "spacemouse") {
    return run_with<DeviceSpaceMouse>(parse_spacemouse_options(arguments[3]), ticks);
  }
  if (name == "pid") return run_with<DevicePid>(parse_pid_options(arguments[3]), ticks);
  fmt::print(stderr, "usage: hid_client woodenhaptics|spacemouse|pid TICKS OPTIONS\n");
  return 1;
} catch (const std::exception& problem) {
  std::fprintf(stderr, "hid_client: %s\n", problem.what());
  return 4;
}
