// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/pid/device_pid.hpp"

#include <string>
#include <utility>

#include "servo/base/clock.hpp"

namespace spm::servo {

DevicePid::DevicePid(const PidOptions& options) : options_(options) {
  capabilities_.name = "pid";
  capabilities_.force_cap = options.force_cap;
  // Assumed: half of the interval, 1 ms, at which a host asks a full-speed device.
  capabilities_.own_delay = 0.5e-3;
  capabilities_.guarded = true;
  capabilities_.stiffness_cap = pid_stiffness_cap;
  capabilities_.workspace = Vector3(options.travel / 2, options.travel / 2, 0);
}

Result<void> DevicePid::open(const DeviceSetup& setup) {
  using Opened = Result<std::unique_ptr<Port<PidReport, PidCommand>>>;
  const auto open_port = [this](const std::atomic<bool>& stop) -> Opened {
    auto port = PidPort::open(options_, stop);
    if (!port) return tl::make_unexpected(std::move(port.error()));
    const std::lock_guard lock(found_mutex_);
    found_ = (*port)->device();
    found_layout_ = (*port)->layout();
    return Opened(std::move(*port));
  };
  Result<void> started = threads_.start(open_port, setup.realtime);
  if (!started) return started;
  const std::lock_guard lock(found_mutex_);
  const HidField& x = found_layout_.position[0];
  capabilities_.buttons = static_cast<std::uint32_t>(found_layout_.buttons.size());
  capabilities_.encoder_step = options_.travel / static_cast<double>(x.logical_max - x.logical_min);
  return {};
}

DeviceHealth DevicePid::health(std::int64_t at_ns) const noexcept {
  if (!threads_.is_open()) return DeviceHealth::gone;
  return came_ns_ == 0 || at_ns - came_ns_ > pid_silent_ns ? DeviceHealth::silent
                                                           : DeviceHealth::ok;
}

DeviceHealth DevicePid::read(DeviceState& state) noexcept {
  if (!threads_.look()) {
    came_ns_ = 0;
  } else {
    static_cast<void>(threads_.take(report_, came_ns_));
  }
  const double half_travel = options_.travel / 2;
  state.position =
      Vector3(half_travel * report_.deflection[0], half_travel * report_.deflection[1], 0);
  state.orientation = Eigen::Quaterniond::Identity();
  state.buttons = report_.buttons;
  return health(now_ns());
}

DeviceHealth DevicePid::write(const Wrench& wrench) noexcept {
  const DeviceHealth now_health = health(now_ns());
  if (now_health == DeviceHealth::gone) return now_health;
  PidCommand command;
  if (now_health == DeviceHealth::ok) {
    command =
        pid_command(wrench.force, options_.full_force, options_.force_cap, options_.force_signs);
  }
  threads_.give(command);
  return now_health;
}

nlohmann::ordered_json DevicePid::describe() const {
  const std::lock_guard lock(found_mutex_);
  nlohmann::ordered_json json{{"product", found_.product_name},
                              {"path", found_.path},
                              {"serial", found_.serial},
                              {"axes", found_layout_.axes},
                              {"direction", to_string(found_layout_.set_effect.direction_form)},
                              {"full_force_N", options_.full_force},
                              {"force_signs", options_.force_signs},
                              {"travel_m", options_.travel},
                              {"watchdog", options_.watchdog},
                              {"reopened", threads_.reopened()},
                              {"latency_us", threads_.latency_us()}};
  threads_.add_last_error(json);
  return json;
}

}  // namespace spm::servo
