// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/base/device_placed.hpp"

#include <nlohmann/json.hpp>
#include <utility>

namespace spm::servo {

namespace {

/// The rotation from a device's frame to the world's. The axes must not mirror.
Eigen::Quaterniond turn_of(const DeviceAxes& axes) {
  Eigen::Matrix3d turn;
  for (Eigen::Index i = 0; i < 3; ++i) turn.col(i) = axes.to_world(Vector3(Vector3::Unit(i)));
  return Eigen::Quaterniond(turn);
}

}  // namespace

PlacedDevice::PlacedDevice(std::unique_ptr<Device> device, const DevicePlacement& placement)
    : device_(std::move(device)), placement_(placement) {
  take_capabilities();
}

void PlacedDevice::take_capabilities() {
  capabilities_ = device_->capabilities();
  capabilities_.workspace = placement_.axes.to_world(capabilities_.workspace).cwiseAbs();
  if (placement_.workspace) capabilities_.workspace = *placement_.workspace;
  if (placement_.stiffness_cap) capabilities_.stiffness_cap = *placement_.stiffness_cap;
  if (placement_.clutch_button > 0) capabilities_.clutch_button = placement_.clutch_button;
}

Result<void> PlacedDevice::open(const DeviceSetup& setup) {
  DeviceSetup turned = setup;
  if (!placement_.axes.mirrored()) {
    Eigen::Quaterniond& rotation = turned.scene.workspace.rotation;
    rotation = (rotation * turn_of(placement_.axes)).normalized();
  }
  auto opened = device_->open(turned);
  if (opened) take_capabilities();
  return opened;
}

DeviceHealth PlacedDevice::read(DeviceState& state) noexcept {
  const DeviceAxes& axes = placement_.axes;
  // What the driver does not change stays as it was.
  DeviceState own{axes.from_world(state.position), axes.from_world(state.orientation),
                  state.buttons};
  const DeviceHealth health = device_->read(own);
  state = {axes.to_world(own.position), axes.to_world(own.orientation), own.buttons};
  return health;
}

DeviceHealth PlacedDevice::write(const Wrench& wrench) noexcept {
  return device_->write(
      {placement_.axes.from_world(wrench.force), placement_.axes.turn_from_world(wrench.torque)});
}

void PlacedDevice::lead(const HandPose* target) noexcept {
  if (target == nullptr) return device_->lead(nullptr);
  const DeviceAxes& axes = placement_.axes;
  const HandPose own{axes.from_world(target->position), axes.from_world(target->orientation)};
  device_->lead(&own);
}

bool PlacedDevice::wait_for_report(std::int64_t until_ns) noexcept {
  return device_->wait_for_report(until_ns);
}

nlohmann::ordered_json PlacedDevice::describe() const {
  nlohmann::ordered_json json = device_->describe();
  json["world_axes"] = placement_.axes.text();
  return json;
}

std::unique_ptr<Device> place_device(std::unique_ptr<Device> device,
                                     const DevicePlacement& placement) {
  if (placement == DevicePlacement{}) return device;
  return std::make_unique<PlacedDevice>(std::move(device), placement);
}

}  // namespace spm::servo
