// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "servo/devices/base/device.hpp"
#include "servo/devices/base/device_placement.hpp"

namespace spm::servo {

/// A device whose axes are the world's by choice, and whose limits are the user's where these are
/// given. What its driver measures and sends is in the driver's own frame, as before; the work that
/// a wrench does is the same in both.
class PlacedDevice final : public Device {
 public:
  PlacedDevice(std::unique_ptr<Device> device, const DevicePlacement& placement);

  /// The scene is told to the driver in its own frame, where that is no mirrored one; in such a
  /// frame it is told as it is. Errors: the driver's.
  [[nodiscard]] Result<void> open(const DeviceSetup& setup) override;
  [[nodiscard]] const DeviceCapabilities& capabilities() const noexcept override {
    return capabilities_;
  }
  [[nodiscard]] DeviceHealth read(DeviceState& state) noexcept override;
  [[nodiscard]] DeviceHealth write(const Wrench& wrench) noexcept override;
  [[nodiscard]] bool wait_for_report(std::int64_t until_ns) noexcept override;
  [[nodiscard]] nlohmann::ordered_json describe() const override;

 private:
  void take_capabilities();

  std::unique_ptr<Device> device_;
  DevicePlacement placement_;
  DeviceCapabilities capabilities_;
};

/// The device as it is placed; itself where nothing is asked for.
[[nodiscard]] std::unique_ptr<Device> place_device(std::unique_ptr<Device> device,
                                                   const DevicePlacement& placement);

}  // namespace spm::servo
