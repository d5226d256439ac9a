// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/loop.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "servo/base/clock.hpp"
#include "servo/devices/base/port.hpp"
#include "servo/realtime/page_faults.hpp"

namespace spm::servo {

namespace {

/// Time from the end of the warm-up to the first tick.
constexpr std::int64_t lead_ns = 2'000'000;

constexpr int warm_up_rounds = 64;

/// A difference of two clocks that are read one after the other is less.
constexpr std::int64_t shortest_sleep_ns = 5'000'000;
/// A machine that wakes finds its devices again in this time; none reports as seldom.
constexpr std::int64_t waking_ns = 250'000'000;

/// For a loop whose pace a device sets: reports are waited for from this fraction of a period
/// before a tick is due, and this fraction after it the tick begins without one. So a device that
/// reports more often than the loop's rate cannot speed it up without bound, and one that falls
/// silent cannot stop it.
constexpr double pace_lead = 0.25, pace_patience = 0.5;

}  // namespace

double stiffness_at_hand(const ForceScene& scene) {
  double stiffest = 0;
  for (const PlacedObject& object : scene.objects) {
    stiffest = std::max(stiffest, object.force.stiffness);
  }
  return stiffest * scene.workspace.scale;
}

Loop::Loop(const LoopSettings& settings, std::vector<Device*> devices,
           std::vector<AssetSlot*> assets, TickRing& ring, const std::atomic<bool>& stop,
           AppState* app, SceneEditSlot* edits)
    : settings_(settings),
      edits_(app != nullptr ? edits : nullptr),
      slots_(std::move(assets)),
      slots_in_use_(edits_ != nullptr ? std::min(slots_.size(), assets_of(settings.scene))
                                      : slots_.size()),
      ring_(ring),
      stop_(stop),
      served_(slots_.size(), nullptr),
      views_(slots_.size(), nullptr),
      stiffness_(stiffness_at_hand(settings.scene)) {
  const std::size_t room = app != nullptr ? AppScene::room(settings.scene) : 0;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    Channel channel(devices[i], settings, room, i);
    channel.record.device = static_cast<std::uint32_t>(i);
    channels_.push_back(std::move(channel));
  }
  for (Channel& channel : channels_) forces_.push_back(&channel.force);
  for (SceneForce* force : forces_) force->meet(forces_);
  if (app != nullptr) app_.emplace(*app, settings_.scene);
  const double scale = settings_.scene.workspace.scale;
  for (std::size_t i = 0; app_ && i < devices.size(); ++i) {
    const DeviceCapabilities& device = devices[i]->capabilities();
    const ForceDevice kind = force_device(device);
    const double tick = 1 / settings_.rate_hz;
    app_->hands().know_device(static_cast<std::uint32_t>(i), device.led);
    app_->effects().know_torque(static_cast<std::uint32_t>(i),
                                channels_[i].safety.torque_cap() > 0);
    app_->effects().know_device(
        static_cast<std::uint32_t>(i),
        {kind.stiffness_cap / scale, felt_limits(kind, tick).damping / scale,
         auto_stiffness(kind) / scale},
        scale * device.encoder_step, tick, channels_[i].force.total_delay());
  }
  published_.resize(channels_.size());
  device_counters_.resize(channels_.size());
}

void Loop::tell_changes(ChangeTeller& changes) noexcept {
  changes_ = &changes;
  // All channels get the same calls.
  if (!channels_.empty()) channels_.front().force.tell(changes_);
}

void Loop::run() noexcept {
  warm_up();
  const std::uint64_t faults_before = page_faults_of_this_thread();
  run_ticks(TickSchedule(now_ns() + lead_ns, settings_.rate_hz));
  counters_.page_faults = page_faults_of_this_thread() - faults_before;
  send_zero();
  if (settings_.beat != nullptr) settings_.beat->store(0, std::memory_order_relaxed);
  for (AssetSlot* slot : slots_) slot->release();
}

/// Waits until a tick is due.
void Loop::wait_for(TickSchedule& schedule) noexcept {
  if (!settings_.paced_by_device) {
    sleep_until(schedule.due());
    return;
  }
  const double period = schedule.period_ns();
  sleep_until(schedule.due() - static_cast<std::int64_t>(pace_lead * period));
  const std::int64_t latest = schedule.due() + static_cast<std::int64_t>(pace_patience * period);
  // The grid follows the device's clock. Without a report the tick is late, and is counted as late.
  if (channels_.front().device->wait_for_report(latest)) {
    schedule.shift_to(now_ns());
  } else {
    sleep_until(schedule.due());
  }
}

void Loop::run_ticks(TickSchedule schedule) noexcept {
  for (bool stopping = false; !stopping;) {
    wait_for(schedule);
    const std::int64_t woke = now_ns();
    due_ = schedule.due();
    const std::int64_t wake_lateness = woke - due_;
    stopping = stop_.load(std::memory_order_relaxed) ||
               (settings_.ticks > 0 && schedule.index() + 1 >= settings_.ticks);

    begin_tick(schedule.index(), woke, stopping);
    const std::int64_t finished = now_ns();
    bool touching = false, degraded = false;
    for (Channel& channel : channels_) {
      touching = touching || channel.record.contact;
      degraded = degraded || channel.record.effort.degraded();
      record(channel, schedule.index(), wake_lateness, finished - woke);
    }
    ++counters_.ticks;
    counters_.contact_ticks += touching ? 1 : 0;
    counters_.degraded_ticks += degraded ? 1 : 0;
    const std::uint64_t skipped = schedule.advance(finished);
    counters_.skipped += skipped;
    counters_.missed += skipped > 0 ? skipped + 1 : 0;
    tell_counts(woke, wake_lateness, finished - woke);
  }
}

/// What a tick does, but for telling how long it took.
void Loop::begin_tick(std::uint64_t tick, std::int64_t woke, bool stopping) noexcept {
  tell_beat(woke);
  if (changes_ != nullptr) changes_->begin(tick);
  take_edit(woke);
  begin_app(woke);
  // After these two, because they may bring an object of an asset that was not needed before.
  take_up();
  follow_delay();
  for (Channel& channel : channels_) serve(channel, tick, stopping);
  end_app(tick, woke);
}

/// Hands a tick's record on.
void Loop::record(Channel& channel, std::uint64_t tick, std::int64_t wake_ns,
                  std::int64_t busy_ns) noexcept {
  TickRecord& record = channel.record;
  record.tick = tick;
  record.wake_ns = wake_ns;
  record.busy_ns = busy_ns;
  const bool kept = ring_.try_enqueue(record);
  record.lost = !kept;
  // A mark that belongs to one tick alone waits for a record that the ring accepts.
  record.edited = record.edited && !kept;
  record.exchanged = record.exchanged && !kept;
  counters_.unrecorded += kept ? 0 : 1;
}

/// Counts with the delay of the slowest device: all forces get the same calls, so that a recording
/// of one tells those of all.
void Loop::follow_delay() noexcept {
  if (!settings_.scene.follows_delay) return;
  bool changed = !std::exchange(delay_told_, true);
  double longest = 0;
  for (Channel& channel : channels_) {
    changed = channel.delay.look(channel.device->delays()) || changed;
    longest = std::max(longest, channel.delay.counted());
  }
  if (!changed) return;
  for (Channel& channel : channels_) {
    channel.force.set_delay(longest);
    if (app_) tell_effects(channel);
  }
}

/// Shows the guards that the loop ticks, and learns whether they had to act.
void Loop::tell_beat(std::int64_t woke) noexcept {
  if (settings_.beat != nullptr) settings_.beat->store(woke, std::memory_order_relaxed);
  const std::int64_t before = std::exchange(last_woke_, woke);
  stood_still_ = before != 0 && woke - before >= loop_stall_ns;
  // CLOCK_MONOTONIC stands still while the machine sleeps.
  const std::int64_t asleep = settings_.asleep();
  const std::int64_t slept = asleep - std::exchange(asleep_, asleep);
  if (before != 0 && slept >= shortest_sleep_ns) awake_from_ = woke + waking_ns;
}

/// An asset without objects may be lost without effect, unless it is the tool.
bool Loop::is_needed(std::size_t asset) const noexcept {
  return !app_ || app_->uses(asset) || is_tool(settings_.scene, asset);
}

void Loop::take_edit(std::int64_t now_ns) noexcept {
  const SceneEdit* edit = edits_ != nullptr ? edits_->pending() : nullptr;
  if (edit == nullptr) return;
  const bool done = app_->edit(*edit, now_ns, forces_);
  if (done) {
    slots_in_use_ = std::clamp(edit->assets, slots_in_use_, slots_.size());
    for (Channel& channel : channels_) channel.record.edited = true;
  }
  edits_->answer_with(done ? EditAnswer::done : EditAnswer::no_room);
}

void Loop::take_up() noexcept {
  bool changed = false;
  complete_ = true;
  for (std::size_t i = 0; i < slots_in_use_; ++i) {
    const ServedAsset* asset = slots_[i]->acquire();
    if (asset != served_[i] && asset != nullptr) {
      changed = true;
      if (app_) app_->set_reach(i, asset->reach());
      if (app_) app_->set_form(i, asset->view->full, forces_);
    }
    if (asset != served_[i] && is_tool(settings_.scene, i)) take_tool(i, asset);
    served_[i] = asset;
    views_[i] = asset != nullptr ? asset->view : nullptr;
    complete_ = complete_ && (asset != nullptr || !is_needed(i));
  }
  had_assets_ = had_assets_ || complete_;
  if (!changed) return;
  for (Channel& channel : channels_) {
    channel.force.exchange();
    channel.record.exchanged = true;
  }
}

/// Hands the samples of a tool, which is of the asset of that number, to all hands that hold it;
/// null for none.
void Loop::take_tool(std::size_t number, const ServedAsset* asset) noexcept {
  for (Channel& channel : channels_) {
    const std::size_t device = channel.record.device;
    const ToolSettings* tool = tool_of(settings_.scene, device);
    if (tool == nullptr || tool->asset != number) continue;
    const Placement& placement = tool->placement;
    channel.force.take_tool(asset != nullptr ? asset->tool_of(device) : nullptr,
                            memory_of(settings_.scene, device));
    if (asset == nullptr) continue;
    channel.arm = (placement.position.norm() + placement.scale * asset->reach()) /
                  settings_.scene.workspace.scale;
    channel.feel(stiffness_, settings_.rate_hz);
  }
}

/// Runs every function of a tick without a device, so that their code, the lazy bindings of the
/// libraries and the assets' tables are in memory before the first tick.
void Loop::warm_up() noexcept {
  for (int round = 0; round < warm_up_rounds; ++round) {
    sleep_until(now_ns());
    take_up();
    for (Channel& channel : channels_) {
      if (assets_off() != ForceOff::none) continue;
      const PlacedObject& object =
          settings_.scene.objects[static_cast<std::size_t>(round) % settings_.scene.objects.size()];
      const Extent extent = extent_of(*views_[object.asset]);
      const Vector3 point = extent.low + (round + 0.5) / warm_up_rounds * extent.size;
      const Vector3 hand = settings_.scene.workspace.from_world(object.placement.to_world(point));
      ForceBudget budget;
      if (round % 2 != 0) budget.most = 0;
      // Turned further in each round, so that a tool meets its objects in many ways.
      const double angle = 0.1 * round;
      const HandPose pose{hand, Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vector3::UnitY()))};
      const ContactForce contact = channel.force.next(views_, pose, 1, budget);
      const Wrench added = added_to(channel, hand);
      static_cast<void>(channel.safety.apply(
          {contact.force + added.force, contact.torque + added.torque}, ForceOff::none));
      const auto number = static_cast<std::uint64_t>(round);
      static_cast<void>(channel.runaway.runs_away(hand, number, 1e-3));
      channel.runaway.sent(std::exp(0.2 * round) * Vector3::UnitX());
    }
    static_cast<void>(page_faults_of_this_thread());
  }
  std::fill(served_.begin(), served_.end(), nullptr);
  had_assets_ = false;
  for (Channel& channel : channels_) {
    static_cast<void>(channel.safety.apply({}, ForceOff::starting));
    channel.record.exchanged = false;
    channel.runaway.forget();
    channel.forget();
  }
}

void Loop::send_zero() noexcept {
  for (Channel& channel : channels_) channel.written = channel.device->write(Wrench{});
}

}  // namespace spm::servo
