// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "servo/devices/base/device.hpp"
#include "servo/devices/base/latency_histogram.hpp"
#include "servo/devices/sim/led_motion.hpp"
#include "servo/devices/sim/pose_motion.hpp"
#include "servo/devices/sim/sim_options.hpp"
#include "servo/devices/sim/sim_plant.hpp"

namespace spm::servo {

/// A simulated device in a simulated hand. Where the scene's tool is an object, or its options say
/// so, it turns. One write is one tick of its time, so that what it does
/// depends on its options and the forces alone, never on the clock.
class DeviceSim final : public Device {
 public:
  explicit DeviceSim(const SimOptions& options);

  /// Errors: those of the hand's trajectory file and of a tool's samples, or an asset without any
  /// surface.
  [[nodiscard]] Result<void> open(const DeviceSetup& setup) override;
  [[nodiscard]] const DeviceCapabilities& capabilities() const noexcept override {
    return capabilities_;
  }
  [[nodiscard]] DeviceHealth read(DeviceState& state) noexcept override;
  [[nodiscard]] DeviceHealth write(const Wrench& wrench) noexcept override;
  void lead(const HandPose* target) noexcept override;
  [[nodiscard]] nlohmann::ordered_json describe() const override;

 private:
  [[nodiscard]] Result<PoseMotion> plan(const DeviceSetup& setup) const;
  [[nodiscard]] HandPose tool() const noexcept;

  SimOptions options_;
  DeviceCapabilities capabilities_;
  SimPlant plant_;
  std::optional<SixdofPlant> turning_;  ///< in place of the other, where the device turns
  PoseMotion motion_;                   ///< where the hand wants to be
  LedMotion led_;                       ///< the same, of a hand that is led
  std::optional<HandPose> leading_;     ///< where to; empty: nobody leads it
  std::int64_t read_ns_ = 0;            ///< when the loop took the last report; 0: it was answered
  LatencyHistogram report_to_command_;
};

}  // namespace spm::servo
