// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <utility>

#include "common/base/device_profile.hpp"
#include "common/base/error.hpp"
#include "common/base/hand_pose.hpp"
#include "common/base/wrench.hpp"
#include "servo/devices/base/delay_counts.hpp"
#include "servo/force/scene_force.hpp"
#include "servo/realtime/realtime.hpp"

namespace spm::servo {

/// Force and torque on the hand: N, and N m about the tool's origin; world frame.
using spm::Wrench;

/// What a device measured, world frame: the position of the tool's origin in metres, the
/// orientation of the tool, and one bit for each button.
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
  silent,     ///< it is there, but no report came for longer than a report may take
  gone,       ///< it was unplugged; it is looked for
  not_homed,  ///< its encoders do not know yet where they are
  /// its user has not confirmed yet which way it counts and pushes; its state is told all the same
  unconfirmed,
};

/// The properties of a device, fixed once it is open.
struct DeviceCapabilities {
  std::string name;
  double force_cap = 0;     ///< N, largest force that may ever be sent; 0: it gives no force
  double encoder_step = 0;  ///< m, smallest step that it resolves, at its centre
  /// N/m, largest stiffness that may be felt with the device.
  double stiffness_cap = std::numeric_limits<double>::infinity();
  /// m, half edges of the box about its origin that contains every position of its tool; 0: not
  /// known.
  Vector3 workspace = Vector3::Zero();
  /// Whether others send it zero force where the loop stands still for loop_stall_ns.
  bool guarded = false;
  std::uint32_t buttons = 0;  ///< how many it has, as far as known
  /// while this button is held the hand moves freely, counted from 1; 0: none
  std::uint32_t clutch_button = 0;
  const DeviceProfile* profile = nullptr;  ///< of its kind; null: not known
  bool turns = false;                      ///< it reads the orientation of its tool
  double torque_cap = 0;  ///< N m, largest torque that may ever be sent; 0: it gives no torque
  double turn_step = 0;   ///< rad, smallest turn that it resolves; 0: not known
  double turning_inertia = 1e-4;  ///< kg m2, the least of its tool about any axis
  /// s: what a force is late by that nothing here measures, from the reading of the encoders to the
  /// coming of the report, and from the command's arrival to the motors.
  double own_delay = 0;
  bool led = false;  ///< applications may say where its hand goes: a simulated one
};

/// The capabilities that a profile gives.
[[nodiscard]] inline DeviceCapabilities capabilities_of(std::string name,
                                                        const DeviceProfile& profile) {
  const std::array<double, 3>& edges = profile.workspace;
  DeviceCapabilities capabilities;
  capabilities.name = std::move(name);
  capabilities.force_cap = profile.force_cap;
  capabilities.encoder_step = profile.encoder_step;
  capabilities.stiffness_cap = profile.stiffness_cap;
  capabilities.workspace = Vector3(edges[0], edges[1], edges[2]) / 2;
  capabilities.profile = find_device_profile(profile.name);
  return capabilities;
}

/// A device as far as the settings of forces depend on it.
[[nodiscard]] inline ForceDevice force_device(const DeviceCapabilities& device) noexcept {
  return {device.profile, device.stiffness_cap};
}

/// A device's turning, as far as the wrench on a tool depends on it.
[[nodiscard]] inline HandTurning hand_turning(const DeviceCapabilities& device) noexcept {
  HandTurning turning;
  turning.reads = device.turns;
  turning.torque_cap = device.turns ? device.torque_cap : 0;
  turning.turn_step = device.turn_step;
  turning.inertia = device.turning_inertia;
  if (device.force_cap > 0) turning.force_cap = device.force_cap;
  return turning;
}

/// What a device may need to know before the loop starts.
struct DeviceSetup {
  double rate_hz = 1000;
  RealtimeMode realtime = RealtimeMode::attempt;  ///< of the threads that a device may have
  ForceScene scene;
  std::span<const AssetView* const> assets;  ///< the scene's; valid while `open` runs, not longer
};

/// A device that the loop drives: one `read`, then one `write`, in each tick.
class Device {
 public:
  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  virtual ~Device() = default;

  /// Makes the device ready. May allocate, block and fail.
  [[nodiscard]] virtual Result<void> open(const DeviceSetup& setup) = 0;
  /// Valid after `open`.
  [[nodiscard]] virtual const DeviceCapabilities& capabilities() const noexcept = 0;
  /// Reads the state. Called by the loop: no allocation, lock or log call. It may block for a small
  /// part of a tick at most.
  [[nodiscard]] virtual DeviceHealth read(DeviceState& state) noexcept = 0;
  /// Sends a wrench, which acts until the next one. Called by the loop, with the limits of `read`.
  [[nodiscard]] virtual DeviceHealth write(const Wrench& wrench) noexcept = 0;
  /// Where the hand of a device that is led is to go, and how it is to be turned, world frame; null
  /// while nobody leads it. Called by the loop, before `read`, with the limits of `read`.
  virtual void lead(const HandPose* target) noexcept { static_cast<void>(target); }
  /// Waits for a report that `read` has not taken yet, at most until a time of CLOCK_MONOTONIC.
  /// False if none came, or if the device cannot set the pace of a loop. Called by the loop, with
  /// the limits of `read`.
  [[nodiscard]] virtual bool wait_for_report(std::int64_t until_ns) noexcept {
    static_cast<void>(until_ns);
    return false;
  }
  /// How long readings and commands were under way; nothing for a device that has no way. Called by
  /// the loop, with the limits of `read`.
  [[nodiscard]] virtual DelayCounts delays() const noexcept { return {}; }
  /// Has a function called whenever the device was found again after a loss, perhaps at another
  /// place: before it is driven, by a thread without real-time priority. Null: no longer, and no
  /// call is under way.
  virtual void when_found_again(const std::function<void()>& tell) { static_cast<void>(tell); }
  /// What a report says of this device beside its capabilities.
  [[nodiscard]] virtual nlohmann::ordered_json describe() const = 0;
};

}  // namespace spm::servo
