// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/place_watch.hpp"

#include "servo/devices/finder/zero_force.hpp"

namespace spm::servo {

Result<void> name_devices(Supervisor& supervisor, const std::vector<Device*>& devices) {
  std::vector<std::string> targets;
  targets.reserve(devices.size());
  for (const Device* device : devices) targets.push_back(zero_force_target(*device));
  return supervisor.watch(targets);
}

void PlaceWatch::look() {
  if (supervisor_ == nullptr) return;
  std::uint64_t reopened = 0;
  for (const Device* device : devices_) reopened += device->reopened();
  if (std::exchange(reopened_, reopened) == reopened) return;
  if (const auto named = name_devices(*supervisor_, devices_); !named) {
    warn_(named.error().message);
    supervisor_ = nullptr;
  }
}

}  // namespace spm::servo
