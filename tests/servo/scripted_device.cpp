// SPDX-License-Identifier: Apache-2.0
#include "tests/servo/scripted_device.hpp"

#include <nlohmann/json.hpp>
#include <utility>

namespace spm::test {

ScriptedDevice::ScriptedDevice(Script script, double force_cap)
    : script_(std::move(script)), capabilities_{"scripted", force_cap, 1e-6} {
  forces_.reserve(1 << 16);
}

servo::DeviceHealth ScriptedDevice::read(servo::DeviceState& state) noexcept {
  servo::DeviceHealth health = servo::DeviceHealth::ok;
  if (stop_ != nullptr && reads_ == last_read_) stop_->store(true);
  script_(reads_++, state, health);
  return health;
}

servo::DeviceHealth ScriptedDevice::write(const servo::Wrench& wrench) noexcept {
  forces_.push_back(wrench.force);
  return servo::DeviceHealth::ok;
}

nlohmann::ordered_json ScriptedDevice::describe() const { return nlohmann::ordered_json::object(); }

}  // namespace spm::test
