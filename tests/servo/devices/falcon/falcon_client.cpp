// SPDX-License-Identifier: Apache-2.0

// Runs a DeviceFalcon at 1 kHz without a loop around it, pulls the hand to the centre with a soft
// spring, and prints what it saw as JSON.
//
// Usage: falcon_client TICKS OPTIONS, with the options of --device falcon.
// Exit code 2, and the sentence, where the device does not open.

#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>

#include "servo/base/clock.hpp"
#include "servo/devices/falcon/device_falcon.hpp"
#include "servo/devices/falcon/falcon_options.hpp"

namespace {

using namespace spm;
using namespace spm::servo;

constexpr std::int64_t period_ns = 1'000'000;
constexpr double spring = 60;  // N/m

constexpr std::array<const char*, 5> health_names{"ok", "fault", "silent", "gone", "not_homed"};

int run(std::uint64_t ticks, const std::string& text) {
  const Result<FalconOptions> options = parse_falcon_options(text);
  if (!options) {
    fmt::print(stderr, "{}\n", options.error().message);
    return static_cast<int>(options.error().code);
  }
  DeviceFalcon device(*options);
  const std::int64_t began = now_ns();
  const Result<void> opened = device.open({});
  if (!opened) {
    fmt::print(stderr, "{}\n", opened.error().message);
    return static_cast<int>(opened.error().code);
  }
  const double open_seconds = static_cast<double>(now_ns() - began) * 1e-9;

  std::array<std::uint64_t, health_names.size()> seen{};
  std::array<std::uint64_t, health_names.size()> written{};
  nlohmann::ordered_json changes = nlohmann::ordered_json::array();
  DeviceHealth last = DeviceHealth::fault;
  Vector3 least = Vector3::Constant(1), most = Vector3::Constant(-1);
  Vector3 before = Vector3::Zero();
  double farthest_step = 0;
  std::uint64_t farthest_step_tick = 0;
  std::int64_t before_ns = 0, farthest_step_time = 0;
  std::uint64_t fresh = 0;
  std::int64_t due = now_ns();
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    due += period_ns;
    sleep_until(due);
    DeviceState state;
    const DeviceHealth health = device.read(state);
    ++seen[static_cast<std::size_t>(health)];
    if (tick == 0 || health != last) {
      changes.push_back(
          {{"tick", tick}, {"health", health_names[static_cast<std::size_t>(health)]}});
    }
    Wrench wrench;
    if (health == DeviceHealth::ok) {
      wrench.force = -spring * state.position;
      least = least.cwiseMin(state.position);
      most = most.cwiseMax(state.position);
      const double step = (state.position - before).norm();
      if (last == DeviceHealth::ok && step > farthest_step) {
        farthest_step = step;
        farthest_step_tick = tick;
        farthest_step_time = now_ns() - before_ns;
      }
      fresh += step > 0 ? 1 : 0;
      before = state.position;
      before_ns = now_ns();
    }
    last = health;
    ++written[static_cast<std::size_t>(device.write(wrench))];
  }
  static_cast<void>(device.write({}));

  nlohmann::ordered_json json{{"open_s", open_seconds}, {"ticks", ticks}};
  for (std::size_t i = 0; i < seen.size(); ++i) {
    json["read"][health_names[i]] = seen[i];
    json["write"][health_names[i]] = written[i];
  }
  json["changes"] = changes;
  json["new_positions"] = fresh;
  json["min_m"] = {least.x(), least.y(), least.z()};
  json["max_m"] = {most.x(), most.y(), most.z()};
  json["farthest_step_m"] = farthest_step;
  json["farthest_step_tick"] = farthest_step_tick;
  json["farthest_step_s"] = static_cast<double>(farthest_step_time) * 1e-9;
  json["device"] = device.describe();
  fmt::print("{}\n", json.dump(2));
  return 0;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 3) {
    fmt::print(stderr, "usage: falcon_client TICKS OPTIONS\n");
    return 1;
  }
  spdlog::set_default_logger(spdlog::stderr_logger_st("falcon_client"));
  return run(std::strtoull(arguments[1], nullptr, 10), arguments[2]);
}
