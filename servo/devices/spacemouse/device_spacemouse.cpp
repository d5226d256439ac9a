// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/spacemouse/device_spacemouse.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "servo/base/clock.hpp"

namespace spm::servo {

DeviceSpaceMouse::DeviceSpaceMouse(const SpaceMouseOptions& options)
    : options_(options), capabilities_{"spacemouse", 0, 0}, motion_(options) {
  capabilities_.turns = true;
}

DeviceSpaceMouse::~DeviceSpaceMouse() { threads_.give({false}); }

Result<void> DeviceSpaceMouse::open(const DeviceSetup& setup) {
  using Opened = Result<std::unique_ptr<Port<SpaceMouseState, SpaceMouseCommand>>>;
  const auto open_port = [this](const std::atomic<bool>&) -> Opened {
    auto port = SpaceMousePort::open(options_);
    if (!port) return tl::make_unexpected(std::move(port.error()));
    static_cast<void>((*port)->send({true}));
    const std::lock_guard lock(found_mutex_);
    found_ = (*port)->device();
    return Opened(std::move(*port));
  };
  // How far the tool moves and turns in one tick at the smallest deflection.
  capabilities_.encoder_step = options_.speed / spacemouse_full_deflection / setup.rate_hz;
  capabilities_.turn_step = options_.turn / spacemouse_full_deflection / setup.rate_hz;
  return threads_.start(open_port, setup.realtime);
}

DeviceHealth DeviceSpaceMouse::health() const noexcept {
  return threads_.is_open() ? DeviceHealth::ok : DeviceHealth::gone;
}

DeviceHealth DeviceSpaceMouse::read(DeviceState& state) noexcept {
  std::int64_t came_ns = 0;
  const DeviceHealth now_health = threads_.look() ? DeviceHealth::ok : DeviceHealth::gone;
  if (threads_.take(mouse_, came_ns)) {
    battery_percent_.store(mouse_.battery_percent, std::memory_order_relaxed);
  }
  // A mouse that is gone moves nothing. When it is back, it begins again at rest.
  if (now_health != DeviceHealth::ok) mouse_ = SpaceMouseState{};
  const std::int64_t now = now_ns();
  const double time = read_ns_ == 0 ? 0 : static_cast<double>(now - read_ns_) * 1e-9;
  read_ns_ = now;
  motion_.step(mouse_, std::clamp(time, 0.0, spacemouse_longest_step));
  state.position = motion_.position();
  state.orientation = motion_.orientation();
  state.buttons = mouse_.buttons;
  return now_health;
}

DeviceHealth DeviceSpaceMouse::write(const Wrench&) noexcept { return health(); }

nlohmann::ordered_json DeviceSpaceMouse::describe() const {
  const int battery = battery_percent_.load(std::memory_order_relaxed);
  const std::lock_guard lock(found_mutex_);
  nlohmann::ordered_json json{{"product", found_.product_name}, {"path", found_.path},
                              {"serial", found_.serial},        {"speed_m_s", options_.speed},
                              {"turn_rad_s", options_.turn},    {"dead_zone", options_.dead_zone},
                              {"box_m", options_.box},          {"reopened", threads_.reopened()}};
  // Its only command is its light.
  json["latency_us"]["report_age"] = threads_.report_age().json_us();
  threads_.add_last_error(json);
  if (battery >= 0) json["battery_percent"] = battery;
  return json;
}

}  // namespace spm::servo
