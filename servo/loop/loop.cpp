// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/loop.hpp"

#include <algorithm>
#include <utility>

#include "servo/base/clock.hpp"
#include "servo/devices/base/port.hpp"
#include "servo/force/contact_part.hpp"
#include "servo/realtime/page_faults.hpp"

namespace spm::servo {

namespace {

/// Time from the end of the warm-up to the first tick.
constexpr std::int64_t lead_ns = 2'000'000;

constexpr int warm_up_rounds = 64;

/// For a loop whose pace a device sets: reports are waited for from this fraction of a period
/// before a tick is due, and this fraction after it the tick begins without one. So a device that
/// reports more often than the loop's rate cannot speed it up without bound, and one that falls
/// silent cannot stop it.
constexpr double pace_lead = 0.25, pace_patience = 0.5;

ForceOff cause_of(DeviceHealth health) noexcept {
  switch (health) {
    case DeviceHealth::ok:
      return ForceOff::none;
    case DeviceHealth::fault:
      return ForceOff::device_fault;
    case DeviceHealth::silent:
      return ForceOff::device_silent;
    case DeviceHealth::gone:
      return ForceOff::device_gone;
    case DeviceHealth::not_homed:
      return ForceOff::not_homed;
  }
  return ForceOff::device_fault;
}

}  // namespace

double stiffness_at_hand(const ForceScene& scene) {
  double stiffest = 0;
  for (const PlacedObject& object : scene.objects) {
    stiffest = std::max(stiffest, object.force.stiffness);
  }
  return stiffest * scene.workspace.scale;
}

Loop::Channel::Channel(Device* driven, const SafetySettings& limits, const LoopSettings& settings,
                       std::size_t room)
    : device(driven),
      safety(limits),
      gate(settings.rate_hz),
      permission(
          {settings.acknowledge, settings.enable_button, driven->capabilities().clutch_button}),
      force(settings.scene, 1 / settings.rate_hz, driven->capabilities().encoder_step, room,
            felt_limits(force_device(driven->capabilities()), 1 / settings.rate_hz)),
      force_cap(limits.force_cap),
      velocity(driven->capabilities().encoder_step, 1 / settings.rate_hz) {}

Loop::Loop(const LoopSettings& settings, std::vector<Device*> devices,
           std::vector<AssetSlot*> assets, TickRing& ring, const std::atomic<bool>& stop,
           AppState* app, SceneEditSlot* edits)
    : settings_(settings),
      edits_(app != nullptr ? edits : nullptr),
      slots_(std::move(assets)),
      slots_in_use_(edits_ != nullptr ? std::min(slots_.size(), assets_of(settings.scene.objects))
                                      : slots_.size()),
      ring_(ring),
      stop_(stop),
      served_(slots_.size(), nullptr),
      views_(slots_.size(), nullptr),
      stiffness_(stiffness_at_hand(settings.scene)) {
  const std::size_t room = app != nullptr ? AppScene::room(settings.scene) : 0;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const DeviceCapabilities& device = devices[i]->capabilities();
    const double cap = std::min(device.force_cap, settings.force_cap);
    const double stiffness = std::min(stiffness_, device.stiffness_cap);
    Channel channel(devices[i], safety_settings(cap, stiffness, settings.rate_hz), settings, room);
    channel.record.device = static_cast<std::uint32_t>(i);
    channels_.push_back(std::move(channel));
  }
  for (Channel& channel : channels_) forces_.push_back(&channel.force);
  if (app != nullptr) app_.emplace(*app, settings_.scene);
  const double scale = settings_.scene.workspace.scale;
  for (std::size_t i = 0; app_ && i < devices.size(); ++i) {
    const DeviceCapabilities& device = devices[i]->capabilities();
    const ForceDevice kind = force_device(device);
    const double tick = 1 / settings_.rate_hz;
    app_->effects().know_device(
        static_cast<std::uint32_t>(i),
        {auto_stiffness(kind) / scale, felt_limits(kind, tick).damping / scale},
        scale * device.encoder_step, tick, settings_.scene.stabilization.total_delay(tick));
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

    tell_beat(woke);
    if (changes_ != nullptr) changes_->begin(schedule.index());
    take_edit(woke);
    begin_app(woke);
    // After these two, because they may bring an object of an asset that was not needed before.
    take_up();
    for (Channel& channel : channels_) serve(channel, schedule.index(), stopping);
    end_app(schedule.index(), woke);

    const std::int64_t finished = now_ns();
    bool touching = false, degraded = false;
    for (Channel& channel : channels_) {
      touching = touching || channel.record.contact;
      degraded = degraded || channel.record.effort.degraded();
      channel.record.tick = schedule.index();
      channel.record.wake_ns = wake_lateness;
      channel.record.busy_ns = finished - woke;
      const bool kept = ring_.try_enqueue(channel.record);
      channel.record.lost = !kept;
      // A mark that belongs to one tick alone waits for a record that the ring accepts.
      channel.record.edited = channel.record.edited && !kept;
      channel.record.exchanged = channel.record.exchanged && !kept;
      counters_.unrecorded += kept ? 0 : 1;
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

/// Shows the guards that the loop ticks, and learns whether they had to act.
void Loop::tell_beat(std::int64_t woke) noexcept {
  if (settings_.beat != nullptr) settings_.beat->store(woke, std::memory_order_relaxed);
  const std::int64_t before = std::exchange(last_woke_, woke);
  stood_still_ = before != 0 && woke - before >= loop_stall_ns;
}

/// Whether the loop stood still before this tick or in it, so that guards sent the device zero. It
/// then gets its force back by the soft start.
bool Loop::was_stopped(const Channel& channel) const noexcept {
  return channel.device->capabilities().guarded &&
         (stood_still_ || now_ns() - last_woke_ >= loop_stall_ns);
}

/// If the asset of one object is missing, a scene gives no force at all.
ForceOff Loop::assets_off() const noexcept {
  if (!complete_) return had_assets_ ? ForceOff::asset_lost : ForceOff::starting;
  for (std::size_t i = 0; i < slots_in_use_; ++i) {
    if (served_[i] != nullptr && served_[i]->lost() && is_needed(i)) return ForceOff::asset_lost;
  }
  return ForceOff::none;
}

/// An asset without objects may be lost without effect.
bool Loop::is_needed(std::size_t asset) const noexcept { return !app_ || app_->uses(asset); }

void Loop::take_edit(std::int64_t now_ns) noexcept {
  const SceneEdit* edit = edits_ != nullptr ? edits_->pending() : nullptr;
  if (edit == nullptr) return;
  const bool done = app_->edit(*edit, now_ns, forces_);
  if (done) {
    slots_in_use_ = std::clamp(edit->assets, slots_in_use_, slots_.size());
    for (Channel& channel : channels_) {
      if (edit->felt) channel.safety.restart();
      channel.record.edited = true;
    }
  }
  edits_->answer_with(done ? EditAnswer::done : EditAnswer::no_room);
}

/// Why the device's answer cannot be used; `none` if it can.
ForceOff Loop::device_off(Channel& channel, DeviceHealth health, const Vector3& position,
                          std::uint64_t tick) noexcept {
  ForceOff cause = cause_of(health);
  if (cause == ForceOff::none) cause = cause_of(channel.written);
  if (cause == ForceOff::none && !position.allFinite()) cause = ForceOff::not_a_number;
  if (cause == ForceOff::none && is_outside(position, channel.device->capabilities().workspace)) {
    cause = ForceOff::outside_workspace;
  }
  if (cause != ForceOff::none) {
    channel.gate.forget();
    return cause;
  }
  return channel.gate.jumped(position, tick) ? ForceOff::jumped : ForceOff::none;
}

/// Whether the hand moves freely, by request of an application or by the device's own button.
bool Loop::is_clutched(const Channel& channel, const DeviceState& state) noexcept {
  const std::uint32_t button = channel.device->capabilities().clutch_button;
  return channel.app_clutched || (button > 0 && ((state.buttons >> (button - 1)) & 1U) != 0);
}

void Loop::serve(Channel& channel, std::uint64_t tick, bool stopping) noexcept {
  DeviceState state;
  const DeviceHealth health = channel.device->read(state);
  if (health == DeviceHealth::ok) {
    channel.believed = state.position;
  } else {
    // A device that tells nothing is still where it was.
    state.position = channel.believed;
  }
  channel.ticks = tick > channel.last_tick ? tick - channel.last_tick : 1;
  channel.last_tick = tick;
  const ForceOff device = device_off(channel, health, state.position, tick);

  // Whatever the cause, the device is still read, and zero is sent to it.
  ForceOff cause = assets_off();
  if (cause == ForceOff::none) cause = device;
  const bool at_fault = cause != ForceOff::none || app_silent_;
  const ForceOff permitted = channel.permission.next(
      {device == ForceOff::none, state.buttons, channel.acknowledged, at_fault});
  // An application that hangs stays the cause as long as it does.
  if (cause == ForceOff::none && permitted == ForceOff::unacknowledged && app_silent_) {
    cause = ForceOff::application_silent;
  }
  if (cause == ForceOff::none) cause = permitted;
  channel.clutched = device == ForceOff::none && is_clutched(channel, state);
  const Vector3 tool = device == ForceOff::none ? tool_of(channel, state.position) : state.position;
  if (cause == ForceOff::none && channel.clutched) cause = ForceOff::clutched;

  ContactForce contact;
  Vector3 added = Vector3::Zero();
  channel.record.forgot = channel.forgot;
  channel.record.effort = {};
  if (cause == ForceOff::none) {
    channel.forgot = false;
    contact = channel.force.next(views_, tool, channel.ticks, budget_of(channel));
    channel.record.effort = channel.force.effort();
    added = added_to(channel, tool);
    // A page of the asset may have been lost while the force was computed from it.
    cause = assets_off();
  }
  if (cause == ForceOff::none && was_stopped(channel)) cause = ForceOff::stalled;
  if (stopping) cause = ForceOff::stopping;
  if (cause != ForceOff::none) {
    contact = ContactForce{};
    added.setZero();
    if (app_) app_->effects().rest(channel.record.device);
    forget(channel);
  }

  const SafeForce sent = channel.safety.apply(contact.force + added, cause, app_silent_);
  channel.written = channel.device->write(Wrench{sent.force, Vector3::Zero()});
  if (sent.cause == ForceOff::none) {
    channel.force.sent(contact_part(sent.force, contact.force, added));
  }
  channel.permission.sent(sent.cause);

  channel.record.position = tool;
  channel.record.wanted = contact.force;
  channel.record.added = added;
  channel.record.force = sent.force;
  channel.record.buttons = state.buttons;
  channel.record.depth = contact.depth;
  channel.record.contact = contact.contact;
  channel.record.cause = sent.cause;
  account(channel, sent);
  if (app_) tell(channel, state, health, contact, sent);
}

/// The devices share the budget evenly, and what one leaves is for the next.
ForceBudget Loop::budget_of(const Channel& channel) const noexcept {
  const double share = (channel.record.device + 1.0) / static_cast<double>(channels_.size());
  ForceBudget budget;
  budget.clock = settings_.clock;
  budget.until_ns =
      due_ + static_cast<std::int64_t>(share * settings_.tick_budget * 1e9 / settings_.rate_hz);
  return budget;
}

/// The tool's position for a position of the hand. It is displaced by as much as the hand moved
/// while it was clutched.
Vector3 Loop::tool_of(Channel& channel, const Vector3& hand) noexcept {
  if (channel.clutched) channel.clutch = channel.tool - hand;
  channel.tool = hand + channel.clutch;
  return channel.tool;
}

void Loop::account(Channel& channel, const SafeForce& sent) noexcept {
  DeviceCounters& counters = device_counters_[channel.record.device];
  const Vector3& position = channel.record.position;
  if (position.allFinite()) {
    if (channel.position_known) {
      counters.energy += channel.last_force.dot(position - channel.last_position);
      counters.generated_max = std::max(counters.generated_max, counters.energy);
    }
    channel.last_position = position;
    channel.position_known = true;
  }
  channel.last_force = sent.force;
  counters.contact_ticks += channel.record.contact ? 1 : 0;
  const ForceEffort& effort = channel.record.effort;
  counters.degraded_ticks += effort.degraded() ? 1 : 0;
  counters.held += effort.held;
  counters.shortened += effort.shortened;
  counters.cap_hits += sent.capped ? 1 : 0;
  counters.slew_hits += sent.slewed ? 1 : 0;
  counters.force_max = std::max(counters.force_max, sent.force.norm());
  if (sent.cause != ForceOff::none) ++counters.force_off[static_cast<std::size_t>(sent.cause)];
}

void Loop::take_up() noexcept {
  bool changed = false;
  complete_ = true;
  for (std::size_t i = 0; i < slots_in_use_; ++i) {
    const ServedAsset* asset = slots_[i]->acquire();
    if (asset != served_[i] && asset != nullptr) {
      changed = true;
      if (app_) app_->set_reach(i, asset->reach());
    }
    served_[i] = asset;
    views_[i] = asset != nullptr ? asset->view : nullptr;
    complete_ = complete_ && (asset != nullptr || !is_needed(i));
  }
  had_assets_ = had_assets_ || complete_;
  if (!changed) return;
  for (Channel& channel : channels_) {
    channel.safety.restart();
    channel.force.exchange();
    channel.record.exchanged = true;
  }
}

void Loop::forget(Channel& channel) noexcept {
  channel.force.reset();
  channel.forgot = true;
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
      const ContactForce contact = channel.force.next(views_, hand, 1, budget);
      const Vector3 force = contact.force + added_to(channel, hand);
      static_cast<void>(channel.safety.apply(force, ForceOff::none));
    }
    static_cast<void>(page_faults_of_this_thread());
  }
  std::fill(served_.begin(), served_.end(), nullptr);
  had_assets_ = false;
  for (Channel& channel : channels_) {
    static_cast<void>(channel.safety.apply(Vector3::Zero(), ForceOff::starting));
    channel.record.exchanged = false;
    forget(channel);
  }
}

void Loop::send_zero() noexcept {
  for (Channel& channel : channels_) channel.written = channel.device->write(Wrench{});
}

}  // namespace spm::servo
