// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/place_watch.hpp"

#include <utility>

#include "servo/devices/finder/zero_force.hpp"

namespace spm::servo {

Result<void> name_devices(Supervisor& supervisor, const std::vector<Device*>& devices) {
  std::vector<std::string> targets;
  targets.reserve(devices.size());
  for (const Device* device : devices) targets.push_back(zero_force_target(*device));
  return supervisor.watch(targets);
}

PlaceWatch::PlaceWatch(Supervisor* supervisor, const std::vector<Device*>& devices)
    : supervisor_(supervisor), devices_(devices) {
  if (supervisor == nullptr) return;
  for (Device* device : devices_) device->when_found_again([this] { name(); });
}

PlaceWatch::~PlaceWatch() {
  for (Device* device : devices_) device->when_found_again(nullptr);
}

void PlaceWatch::name() {
  const std::lock_guard lock(mutex_);
  if (supervisor_ == nullptr) return;
  if (auto named = name_devices(*supervisor_, devices_); !named) {
    fault_ = std::move(named.error().message);
  }
}

std::string PlaceWatch::take_fault() {
  const std::lock_guard lock(mutex_);
  return std::exchange(fault_, {});
}

}  // namespace spm::servo
