// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "common/error.hpp"
#include "common/scene_force.hpp"
#include "common/wrench.hpp"
#include "servo/realtime.hpp"

namespace spm::servo {

/// What acts on the hand: N, and N m about the tool's origin; world frame.
using spm::Wrench;

/// What a device measured: position of the tool's origin in metres, and how the tool is turned,
/// world frame; one bit a button.
struct DeviceState {
  Vector3 position = Vector3::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  ///< unit
  std::uint32_t buttons = 0;
};

/// Whether a device can be trusted now. Anything but `ok` means zero force, with a cause of its
/// own.
enum class DeviceHealth : std::uint8_t {
  ok,
  fault,      ///< it answered what makes no sense
  silent,     ///< it is there, but no report came for longer than it may take
  gone,       ///< it was unplugged; it is looked for
  not_homed,  ///< its encoders do not know yet where they are
};

/// What a device can do; fixed once it is open.
struct DeviceCapabilities {
  std::string name;
  double force_cap = 0;     ///< N, largest force that may ever be sent to it; 0: it gives none
  double encoder_step = 0;  ///< m, smallest step that it resolves at its centre
};

/// What a device may need to know before the loop starts.
struct DeviceSetup {
  double rate_hz = 1000;
  RealtimeMode realtime = RealtimeMode::attempt;  ///< of threads that a device may have
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
