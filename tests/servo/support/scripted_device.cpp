// SPDX-License-Identifier: Apache-2.0
#include "tests/servo/support/scripted_device.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "servo/base/clock.hpp"

namespace spm::test {

ScriptedDevice::ScriptedDevice(Script script, double force_cap) : script_(std::move(script)) {
  capabilities_.name = "scripted";
  capabilities_.force_cap = force_cap;
  capabilities_.encoder_step = 1e-6;
  forces_.reserve(1 << 16);
  torques_.reserve(1 << 16);
}

servo::DeviceHealth ScriptedDevice::read(servo::DeviceState& state) noexcept {
  servo::DeviceHealth health = servo::DeviceHealth::ok;
  if (stop_ != nullptr && reads_ == last_read_) stop_->store(true);
  script_(reads_++, state, health);
  return health;
}

bool ScriptedDevice::wait_for_report(std::int64_t until_ns) noexcept {
  if (period_ns_ == 0) return false;
  if (reported_ns_ == 0) reported_ns_ = servo::now_ns();
  const std::int64_t next = reported_ns_ + period_ns_;
  servo::sleep_until(std::min(next, until_ns));
  if (next > until_ns) return false;
  // One that came while the loop was late is taken at once; what is older is lost.
  reported_ns_ = std::max(next, servo::now_ns() - period_ns_);
  return true;
}

servo::DeviceHealth ScriptedDevice::write(const servo::Wrench& wrench) noexcept {
  forces_.push_back(wrench.force);
  torques_.push_back(wrench.torque);
  return servo::DeviceHealth::ok;
}

nlohmann::ordered_json ScriptedDevice::describe() const { return nlohmann::ordered_json::object(); }

}  // namespace spm::test
