// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

#include "servo/devices/base/device.hpp"
#include "servo/devices/base/device_placement.hpp"

namespace spm::servo {

/// A device around another one: its axes are mapped to the world's as the user chose, and its
/// limits are the user's if they are given. The driver still measures and sends in its own frame.
/// The work of a wrench is the same in both frames.
class PlacedDevice final : public Device {
 public:
  PlacedDevice(std::unique_ptr<Device> device, const DevicePlacement& placement);

  /// The driver gets the scene in its own frame, unless that frame is mirrored; then it gets the
  /// scene unchanged. Errors: the driver's.
  [[nodiscard]] Result<void> open(const DeviceSetup& setup) override;
  [[nodiscard]] const DeviceCapabilities& capabilities() const noexcept override {
    return capabilities_;
  }
  [[nodiscard]] DeviceHealth read(DeviceState& state) noexcept override;
  [[nodiscard]] DeviceHealth write(const Wrench& wrench) noexcept override;
  void lead(const HandPose* target) noexcept override;
  [[nodiscard]] bool wait_for_report(std::int64_t until_ns) noexcept override;
  [[nodiscard]] DelayCounts delays() const noexcept override { return device_->delays(); }
  void when_found_again(const std::function<void()>& tell) override {
    device_->when_found_again(tell);
  }
  [[nodiscard]] nlohmann::ordered_json describe() const override;

 private:
  void take_capabilities();

  std::unique_ptr<Device> device_;
  DevicePlacement placement_;
  DeviceCapabilities capabilities_;
};

/// The device with this placement, or the device itself if the placement changes nothing.
[[nodiscard]] std::unique_ptr<Device> place_device(std::unique_ptr<Device> device,
                                                   const DevicePlacement& placement);

}  // namespace spm::servo
