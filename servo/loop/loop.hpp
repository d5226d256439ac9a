// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "servo/app/app_scene.hpp"
#include "servo/base/clock.hpp"
#include "servo/base/schedule.hpp"
#include "servo/devices/base/device.hpp"
#include "servo/force/scene_force.hpp"
#include "servo/force/velocity_estimate.hpp"
#include "servo/record/scene_step.hpp"
#include "servo/record/tick_record.hpp"
#include "servo/safety/device_counters.hpp"
#include "servo/safety/force_permission.hpp"
#include "servo/scene/asset_slot.hpp"
#include "servo/scene/scene_edit.hpp"

namespace spm::servo {

/// The share of a period that is for the exact forces of all devices. The rest is for coarser ones,
/// for sending and for being woken late.
inline constexpr double usual_tick_budget = 0.6;

/// Fixed while the loop runs.
struct LoopSettings {
  double rate_hz = 1000;
  std::uint64_t ticks = 0;  ///< stops after this many ticks of the grid; 0: when `stop` is set
  ForceScene scene = scene_of({});
  /// N, in addition to each device's own
  double force_cap = std::numeric_limits<double>::infinity();
  /// a tick follows each report of the first device instead of the clock
  bool paced_by_device = false;
  bool acknowledge = false;         ///< after a fault the force waits for an acknowledgement
  std::uint32_t enable_button = 0;  ///< without it held there is no force; from 1, 0: none
  /// of the period, above 0: when so much is over, objects that are left are computed more coarsely
  double tick_budget = usual_tick_budget;
  ForceBudget::Clock clock = now_ns;  ///< by which that is told
  /// where each tick leaves the time that it began, now_ns(), and the loop's end 0; null for
  /// nowhere. It must outlive the loop.
  std::atomic<std::int64_t>* beat = nullptr;
};

/// The largest stiffness that an object of a scene can have, N per metre of the hand.
[[nodiscard]] double stiffness_at_hand(const ForceScene& scene);

/// What the loop counted.
struct LoopCounters {
  std::uint64_t ticks = 0;    ///< that were run
  std::uint64_t missed = 0;   ///< not finished before the next one was due, including skipped ones
  std::uint64_t skipped = 0;  ///< missed ticks that were not run at all
  std::uint64_t contact_ticks = 0;   ///< with any device in contact
  std::uint64_t unrecorded = 0;      ///< records that did not fit into the full ring
  std::uint64_t degraded_ticks = 0;  ///< in which any object was computed more coarsely
  std::uint64_t page_faults = 0;     ///< in the loop's thread, from the first tick to the last
};

/// The servo loop. Construction allocates. `run` belongs to one thread; a tick in it neither
/// allocates, locks, logs nor faults.
class Loop {
 public:
  /// Devices must be open. `assets`: a slot for each asset that the scene's objects name, and after
  /// them spare slots for assets that `edits` bring. `app`: what the loop shares with applications;
  /// null for nothing. `edits`: of the scene, for a loop with applications; null for none.
  /// Everything referred to must outlive the loop.
  Loop(const LoopSettings& settings, std::vector<Device*> devices, std::vector<AssetSlot*> assets,
       TickRing& ring, const std::atomic<bool>& stop, AppState* app = nullptr,
       SceneEditSlot* edits = nullptr);

  /// Before `run`: tells every change of the scene's objects, with its tick. `changes` must outlive
  /// the loop.
  void tell_changes(ChangeTeller& changes) noexcept;

  /// Runs until `stop` is set, or until the settings' ticks are over. The last wrench that is sent
  /// is zero.
  void run() noexcept;

  /// Valid when `run` has returned.
  [[nodiscard]] const LoopCounters& counters() const noexcept { return counters_; }
  [[nodiscard]] const DeviceCounters& device_counters(std::size_t device) const {
    return device_counters_[device];
  }

 private:
  /// One device, and the state that the loop keeps for it from tick to tick.
  struct Channel {
    /// `room`: number of objects that can be added to the scene.
    Channel(Device* driven, const SafetySettings& limits, const LoopSettings& settings,
            std::size_t room);

    Device* device;
    SafetyStage safety;
    JumpGate gate;
    ForcePermission permission;
    SceneForce force;
    TickRecord record;
    std::uint64_t ticks = 1;  ///< since the force law was last called
    std::uint64_t last_tick = 0;
    Vector3 believed = Vector3::Zero();  ///< m: the last place that the device told and that can be
    Vector3 last_position = Vector3::Zero();
    Vector3 last_force = Vector3::Zero();
    bool position_known = false;
    bool forgot = true;                ///< the force law was reset since it was last called
    double force_cap;                  ///< N, of device and scene; applications may lower it
    bool acknowledged = false;         ///< a fault, by an application in this tick
    bool app_clutched = false;         ///< an application lets the hand move freely
    bool clutched = false;             ///< the hand moves freely, the tool stays
    Vector3 clutch = Vector3::Zero();  ///< m, from the hand to the tool
    Vector3 tool = Vector3::Zero();    ///< m, where the force law was last evaluated
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
  [[nodiscard]] bool was_stopped(const Channel& channel) const noexcept;
  void tell_beat(std::int64_t woke) noexcept;
  void account(Channel& channel, const SafeForce& sent) noexcept;
  [[nodiscard]] ForceBudget budget_of(const Channel& channel) const noexcept;
  [[nodiscard]] static Vector3 tool_of(Channel& channel, const Vector3& hand) noexcept;
  [[nodiscard]] Vector3 added_to(Channel& channel, const Vector3& tool) noexcept;
  [[nodiscard]] bool is_needed(std::size_t asset) const noexcept;
  void take_edit(std::int64_t now_ns) noexcept;
  void begin_app(std::int64_t now_ns) noexcept;
  void follow_stiffness(double stiffness) noexcept;
  void end_app(std::uint64_t tick, std::int64_t now_ns) noexcept;
  void tell_counts(std::int64_t woke, std::int64_t wake_ns, std::int64_t busy_ns) noexcept;
  void tell(Channel& channel, const DeviceState& state, DeviceHealth health,
            const ContactForce& contact, const SafeForce& sent) noexcept;
  void take_up() noexcept;
  static void forget(Channel& channel) noexcept;
  void send_zero() noexcept;

  LoopSettings settings_;
  std::vector<Channel> channels_;
  std::vector<SceneForce*> forces_;  ///< of the channels
  std::optional<AppScene> app_;
  std::vector<AppDevice> published_;             ///< what applications learn, one for each device
  std::vector<DeviceCounters> device_counters_;  ///< one for each device
  SceneEditSlot* edits_;
  std::vector<AssetSlot*> slots_;
  std::size_t slots_in_use_;  ///< the others are spare
  TickRing& ring_;
  ChangeTeller* changes_ = nullptr;
  const std::atomic<bool>& stop_;
  LoopCounters counters_;
  // One for each asset, null if there is none now:
  std::vector<const ServedAsset*> served_;
  std::vector<const AssetView*> views_;
  double stiffness_;            ///< N per metre of the hand, of the stiffest object in the scene
  std::int64_t last_woke_ = 0;  ///< when the last tick began; 0: none did
  std::int64_t due_ = 0;        ///< when this tick was due
  bool stood_still_ = false;    ///< before this tick, for so long that guards sent zero force
  bool app_silent_ = false;     ///< an application that moved objects no longer answers
  bool complete_ = false;       ///< all assets are there
  bool had_assets_ = false;     ///< they were all there once
};

}  // namespace spm::servo
