// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "common/error.hpp"
#include "common/scene_force.hpp"

namespace spm::servo {

/// What acts on the hand: force in newtons, torque in newton metres about the tool's origin; world
/// frame.
struct Wrench {
  Vector3 force = Vector3::Zero();
  Vector3 torque = Vector3::Zero();
};

/// What a device measured: position of the tool's origin in metres, world frame; one bit a button.
struct DeviceState {
  Vector3 position = Vector3::Zero();
  std::uint32_t buttons = 0;
};

/// Whether the last exchange with the device can be trusted.
enum class DeviceHealth : std::uint8_t {
  ok,
  fault,  ///< no answer, or one that makes no sense; the loop sends zero force until it is over
};

/// What a device can do; fixed once it is open.
struct DeviceCapabilities {
  std::string name;
  double force_cap = 0;     ///< N, largest force that may ever be sent to it
  double encoder_step = 0;  ///< m, smallest step that it resolves at its centre
};

/// What a device may need to know before the loop starts.
struct DeviceSetup {
  double rate_hz = 1000;
  ForceScene scene;
  std::span<const AssetView* const> assets;  ///< the scene's; valid while `open` runs, not later
};

/// A device that the loop drives: one `read`, then one `write`, a tick.
class Device {
 public:
  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  virtual ~Device() = default;

  /// Gets ready; may allocate, block and fail.
  [[nodiscard]] virtual Result<void> open(const DeviceSetup& setup) = 0;
  /// Valid after `open`.
  [[nodiscard]] virtual const DeviceCapabilities& capabilities() const noexcept = 0;
  /// Reads the state. Called by the loop: no allocation, lock or log call; blocks for a small part
  /// of a tick at most.
  [[nodiscard]] virtual DeviceHealth read(DeviceState& state) noexcept = 0;
  /// Sends a wrench, which acts until the next one. Called by the loop, as `read`.
  [[nodiscard]] virtual DeviceHealth write(const Wrench& wrench) noexcept = 0;
  /// What a report says of this device beside its capabilities.
  [[nodiscard]] virtual nlohmann::ordered_json describe() const = 0;
};

}  // namespace spm::servo
