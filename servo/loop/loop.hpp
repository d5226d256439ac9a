// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "servo/force/scene_force.hpp"
#include "servo/force/velocity_estimate.hpp"
#include "servo/app/app_scene.hpp"
#include "servo/devices/base/device.hpp"
#include "servo/safety/device_counters.hpp"
#include "servo/scene/asset_slot.hpp"
#include "servo/scene/scene_edit.hpp"
#include "servo/base/schedule.hpp"
#include "servo/record/tick_record.hpp"

namespace spm::servo {

/// Fixed while the loop runs.
struct LoopSettings {
  double rate_hz = 1000;
  std::uint64_t ticks = 0;  ///< stops after so many ticks of the grid; 0: when told to
  ForceScene scene = scene_of({});
  double force_cap = std::numeric_limits<double>::infinity();  ///< N, beside each device's own
  bool paced_by_device = false;  ///< a tick follows each report of the first device, not the clock
};

/// The stiffest that one object of a scene can feel, N a metre of the hand.
[[nodiscard]] double stiffness_at_hand(const ForceScene& scene);

/// What the loop counted.
struct LoopCounters {
  std::uint64_t ticks = 0;          ///< run
  std::uint64_t missed = 0;         ///< not finished before the next was due, skipped ones included
  std::uint64_t skipped = 0;        ///< of the missed ones, those not run at all
  std::uint64_t contact_ticks = 0;  ///< with any device in contact
  std::uint64_t unrecorded = 0;     ///< records that the full ring refused
  std::uint64_t page_faults = 0;    ///< in the loop's thread, from the first tick to the last
};

/// The servo loop. Construction allocates; `run` belongs to one thread, in which a tick neither
/// allocates, locks, logs nor faults.
class Loop {
 public:
  /// Devices must be open. `assets`: a slot for each asset that the scene's objects name, behind
  /// them spare ones for those that `edits` bring. `app`: what the loop shares with applications;
  /// null for nothing. `edits`: of the scene, for a loop with applications; null for none.
  /// Everything referred to must outlive the loop.
  Loop(const LoopSettings& settings, std::vector<Device*> devices, std::vector<AssetSlot*> assets,
       TickRing& ring, const std::atomic<bool>& stop, AppState* app = nullptr,
       SceneEditSlot* edits = nullptr);

  /// Runs until `stop`, or until the settings' ticks are over; the last wrench sent is zero.
  void run() noexcept;

  /// Valid when `run` has returned.
  [[nodiscard]] const LoopCounters& counters() const noexcept { return counters_; }
  [[nodiscard]] const DeviceCounters& device_counters(std::size_t device) const {
    return device_counters_[device];
  }

 private:
  /// One device and what the loop remembers of it from tick to tick.
  struct Channel {
    /// `room`: objects that may be added to the scene.
    Channel(Device* driven, const SafetySettings& limits, const LoopSettings& settings,
            std::size_t room);

    Device* device;
    SafetyStage safety;
    JumpGate gate;
    SceneForce force;
    TickRecord record;
    Vector3 last_position = Vector3::Zero();
    Vector3 last_force = Vector3::Zero();
    bool position_known = false;
    bool forgot = true;                ///< the force law was reset since it was last asked
    bool app_clutched = false;         ///< an application lets the hand move freely
    bool clutched = false;             ///< the hand moves freely, the tool stays
    Vector3 clutch = Vector3::Zero();  ///< m, from the hand to the tool
    Vector3 tool = Vector3::Zero();    ///< m, where the force law was last asked
    VelocityEstimate velocity;         ///< of the tool
    DeviceHealth written = DeviceHealth::ok;
  };

  void warm_up() noexcept;
  void run_ticks(TickSchedule schedule) noexcept;
  void wait_for(TickSchedule& schedule) noexcept;
  void serve(Channel& channel, std::uint64_t tick, bool stopping) noexcept;
  [[nodiscard]] static ForceOff device_off(Channel& channel, DeviceHealth health,
                                           const Vector3& position, std::uint64_t tick) noexcept;
  [[nodiscard]] static bool is_clutched(const Channel& channel, const DeviceState& state) noexcept;
  [[nodiscard]] ForceOff assets_off() const noexcept;
  void account(Channel& channel, const SafeForce& sent) noexcept;
  [[nodiscard]] static Vector3 tool_of(Channel& channel, const Vector3& hand) noexcept;
  [[nodiscard]] bool is_needed(std::size_t asset) const noexcept;
  void take_edit(std::int64_t now_ns) noexcept;
  void begin_app(std::int64_t now_ns) noexcept;
  void follow_stiffness(double stiffness) noexcept;
  void end_app(std::uint64_t tick, std::int64_t now_ns) noexcept;
  void tell_counts(std::int64_t woke, std::int64_t wake_ns, std::int64_t busy_ns) noexcept;
  void tell(Channel& channel, const DeviceState& state, DeviceHealth health,
            const SafeForce& sent) noexcept;
  void take_up() noexcept;
  static void forget(Channel& channel) noexcept;
  void send_zero() noexcept;

  LoopSettings settings_;
  std::vector<Channel> channels_;
  std::vector<SceneForce*> forces_;  ///< of the channels
  std::optional<AppScene> app_;
  std::vector<AppDevice> told_;                  ///< what applications are told, one a channel
  std::vector<DeviceCounters> device_counters_;  ///< one a channel
  SceneEditSlot* edits_;
  std::vector<AssetSlot*> slots_;
  std::size_t slots_in_use_;  ///< the others are spare
  TickRing& ring_;
  const std::atomic<bool>& stop_;
  LoopCounters counters_;
  // One an asset, null where there is none now:
  std::vector<const ServedAsset*> served_;
  std::vector<const AssetView*> views_;
  double stiffness_;         ///< N a metre of the hand, of the stiffest object that there is
  bool app_silent_ = false;  ///< an application that moved objects does not answer
  bool complete_ = false;    ///< all assets are there
  bool had_assets_ = false;  ///< they were once
};

}  // namespace spm::servo
