// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "servo/app/app_scene.hpp"
#include "servo/base/schedule.hpp"
#include "servo/devices/base/device.hpp"
#include "servo/force/scene_force.hpp"
#include "servo/loop/channel.hpp"
#include "servo/loop/loop_settings.hpp"
#include "servo/record/scene_step.hpp"
#include "servo/record/tick_record.hpp"
#include "servo/scene/asset_slot.hpp"
#include "servo/scene/scene_edit.hpp"
#include "servo/stabilize/velocity_estimate.hpp"

namespace spm::servo {

/// What a device's delay came to.
struct LoopDelay {
  double measured = 0;  ///< ticks
  double counted = 0;   ///< ticks
  double stiffest = 0;  ///< N/m at the hand
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
  /// One tick of the grid alone, at a time that the caller gives, as of now_ns: for simulations
  /// that do not wait for the clock. Not beside `run`.
  void step(std::uint64_t tick, std::int64_t now_ns) noexcept { begin_tick(tick, now_ns, false); }
  /// What was recorded of a device's last tick.
  [[nodiscard]] const TickRecord& record_of(std::size_t device) const {
    return channels_[device].record;
  }

  /// Valid when `run` has returned.
  [[nodiscard]] const LoopCounters& counters() const noexcept { return counters_; }
  [[nodiscard]] const DeviceCounters& device_counters(std::size_t device) const {
    return device_counters_[device];
  }
  /// The same: the delay from a reading to its force, as it was measured last and as it is counted
  /// with, ticks; and the largest stiffness of an object as it was felt in the end, N/m at the
  /// hand.
  [[nodiscard]] LoopDelay delay(std::size_t device) const {
    const Channel& channel = channels_[device];
    return {channel.delay.measured(), channel.force.counted_delay(), channel.force.stiffest()};
  }

 private:
  void warm_up() noexcept;
  void run_ticks(TickSchedule schedule) noexcept;
  void begin_tick(std::uint64_t tick, std::int64_t woke, bool stopping) noexcept;
  void wait_for(TickSchedule& schedule) noexcept;
  void serve(Channel& channel, std::uint64_t tick, bool stopping) noexcept;
  [[nodiscard]] ForceOff cause_before_forces(Channel& channel, ForceOff device,
                                             const DeviceState& state) noexcept;
  [[nodiscard]] ForceOff assets_off() const noexcept;
  [[nodiscard]] bool was_stopped(const Channel& channel) const noexcept;
  void tell_beat(std::int64_t woke) noexcept;
  static void note_tool(Channel& channel) noexcept;
  void follow_delay() noexcept;
  void tell_effects(const Channel& channel) noexcept;
  [[nodiscard]] ForceBudget budget_of(const Channel& channel) const noexcept;
  [[nodiscard]] Wrench added_to(Channel& channel, const Vector3& tool) noexcept;
  [[nodiscard]] bool is_needed(std::size_t asset) const noexcept;
  void take_edit(std::int64_t now_ns) noexcept;
  void begin_app(std::int64_t now_ns) noexcept;
  void follow_stiffness(double stiffness) noexcept;
  void lead(Channel& channel, const HandPose* world) noexcept;
  void end_app(std::uint64_t tick, std::int64_t now_ns) noexcept;
  void tell_counts(std::int64_t woke, std::int64_t wake_ns, std::int64_t busy_ns) noexcept;
  void tell(Channel& channel, const DeviceState& state, DeviceHealth health,
            const ContactForce& contact, const SafeWrench& sent) noexcept;
  static void tell_tool(Channel& channel, AppDevice& published) noexcept;
  [[nodiscard]] static std::span<const ContactPatch> touches(Channel& channel) noexcept;
  [[nodiscard]] HandPose hand_of_tool(const HandPose& tool, std::size_t device) const noexcept;
  void take_up() noexcept;
  void take_tool(std::size_t number, const ServedAsset* asset) noexcept;
  void record(Channel& channel, std::uint64_t tick, std::int64_t wake_ns,
              std::int64_t busy_ns) noexcept;
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
  double stiffness_;             ///< N per metre of the hand, of the stiffest object in the scene
  std::int64_t last_woke_ = 0;   ///< when the last tick began; 0: none did
  std::int64_t due_ = 0;         ///< when this tick was due
  bool stood_still_ = false;     ///< before this tick, for so long that guards sent zero force
  std::int64_t asleep_ = 0;      ///< ns that the machine had slept in the last tick
  std::int64_t awake_from_ = 0;  ///< until then what devices tell may be from before a sleep
  bool delay_told_ = false;      ///< forces know the devices' delays
  bool app_silent_ = false;      ///< an application that moved objects no longer answers
  bool complete_ = false;        ///< all assets are there
  bool had_assets_ = false;      ///< they were all there once
};

}  // namespace spm::servo
