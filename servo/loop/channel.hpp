// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "servo/devices/base/device.hpp"
#include "servo/force/kept_side.hpp"
#include "servo/force/scene_force.hpp"
#include "servo/loop/delay_watch.hpp"
#include "servo/loop/loop_settings.hpp"
#include "servo/record/tick_record.hpp"
#include "servo/safety/device_counters.hpp"
#include "servo/safety/force_permission.hpp"
#include "servo/safety/runaway_guard.hpp"
#include "servo/stabilize/velocity_estimate.hpp"

namespace spm::servo {

/// What holds for one device, by its number, in a run of these settings.
[[nodiscard]] SafetySettings device_limits(const DeviceCapabilities& device,
                                           const LoopSettings& settings, std::size_t number = 0);

/// The turning of a device as the forces on a tool are made for it: with the caps of the run. A cap
/// of 0 N is none, since then nothing is sent.
[[nodiscard]] HandTurning turning_in_run(const DeviceCapabilities& device,
                                         const LoopSettings& settings, std::size_t number = 0);

/// The clutch of one device: while it is held, the hand moves and turns freely and the tool stays.
/// Afterwards the tool follows the hand's motions from where it stayed, each in the same direction
/// and about the same axis, so that a wrench does the same work on both.
class Clutch {
 public:
  /// The pose of the tool for a pose of the hand, both in the hand's frame.
  [[nodiscard]] HandPose tool_of(const HandPose& hand, bool held) noexcept;

 private:
  Vector3 way_ = Vector3::Zero();                             ///< m, from the hand to the tool
  Eigen::Quaterniond turn_ = Eigen::Quaterniond::Identity();  ///< from the hand to the tool
  HandPose tool_;                                             ///< where it was last
};

/// The velocities of one hand, m/s and rad/s, in the hand's frame.
class HandVelocity {
 public:
  /// `encoder_step` in m, `turn_step` in rad, `tick` in s.
  HandVelocity(double encoder_step, double turn_step, double tick) noexcept
      : velocity_(encoder_step, tick), turning_(turn_step, tick) {}

  /// A pose, `ticks` after the last one.
  void take(const HandPose& hand, std::uint64_t ticks) noexcept;
  /// Forgets all state: the hand is away.
  void reset() noexcept;

  [[nodiscard]] const Vector3& velocity() const noexcept { return now_; }
  [[nodiscard]] const Vector3& angular_velocity() const noexcept { return turning_now_; }

 private:
  VelocityEstimate velocity_, turning_;
  Eigen::Quaterniond last_ = Eigen::Quaterniond::Identity();
  bool last_known_ = false;
  Vector3 turned_ = Vector3::Zero();  ///< rad, the sum of all turns
  Vector3 now_ = Vector3::Zero(), turning_now_ = Vector3::Zero();
};

/// The work of what was sent to one device: the wrench of each tick along the motion that followed,
/// force times way and torque times turn.
class WorkAccount {
 public:
  /// J, on the hand, of the wrench that was sent last, now that the hand is here. `sent` acts from
  /// now on.
  [[nodiscard]] double next(const HandPose& hand, const Wrench& sent) noexcept;
  /// The way to the next place is not believed.
  void forget() noexcept { last_known_ = false; }

 private:
  HandPose last_;
  Wrench sent_;
  bool last_known_ = false;
};

/// One device, and the state that the loop keeps for it from tick to tick.
struct Channel {
  /// `room`: number of objects that can be added to the scene. `number`: of the device. Allocates.
  Channel(Device* driven, const LoopSettings& settings, std::size_t room, std::size_t number = 0);

  /// Reads the device. One that tells nothing is still where it was.
  [[nodiscard]] DeviceHealth read(DeviceState& state, std::uint64_t tick) noexcept;
  /// Why the device's answer cannot be used; `none` if it can.
  [[nodiscard]] ForceOff off(DeviceHealth health, const HandPose& hand,
                             std::uint64_t tick) noexcept;
  /// Whether the device's own clutch button is held, so that the hand moves freely.
  [[nodiscard]] bool is_clutched_by_button(const DeviceState& state) const noexcept;
  /// The cause; or, where there is none, `runaway` if the device pushes the wrong way.
  [[nodiscard]] ForceOff unless_runaway(ForceOff cause, const HandPose& hand,
                                        std::uint64_t tick) noexcept;
  /// Counts a tick, whose record is complete.
  void account(DeviceCounters& counters, const SafeWrench& sent) noexcept;
  /// The force law forgets all.
  void forget() noexcept;
  /// A tick without force: the hand keeps its side of what it touches.
  void rest() noexcept;
  /// Force comes back, with the tool at that place. One that went farther than `kept_way` meanwhile
  /// is on no side any more.
  void resume(const HandPose& tool) noexcept;
  /// Sets the slew limits for what is felt, N/m at the hand.
  void feel(double stiffness, double rate_hz) noexcept;

  Device* device;
  SafetyStage safety;
  JumpGate gate;
  RunawayGuard runaway;
  ForcePermission permission;
  SceneForce force;
  TickRecord record;
  std::uint64_t ticks = 1;  ///< since the force law was last called
  std::uint64_t last_tick = 0;
  HandPose believed;     ///< the last pose that the device told
  HandPose left_at;      ///< the tool in the last tick with force
  bool resting = false;  ///< there was none in the last tick
  double force_cap;      ///< N, of device and scene; applications may lower it
  double arm = 0;        ///< m of the hand, how far the tool's farthest place is from it
  Clutch clutch;
  HandVelocity motion;  ///< of the tool
  WorkAccount work;
  DelayWatch delay;
  std::array<ContactPatch, max_patches> touches{};  ///< of a point or a ball in this tick
  DeviceHealth written = DeviceHealth::ok;
  bool forgot = true;         ///< the force law was reset since it was last called
  bool acknowledged = false;  ///< a fault, by an application in this tick
  bool app_clutched = false;  ///< an application lets the hand move freely
  bool led = false;           ///< an application leads the hand, of a simulated device
  bool clutched = false;      ///< the hand moves freely, the tool stays
};

}  // namespace spm::servo
