// SPDX-License-Identifier: Apache-2.0
// The part of the loop that serves one device in one tick.
#include "servo/base/clock.hpp"
#include "servo/devices/base/port.hpp"
#include "servo/force/contact_part.hpp"
#include "servo/loop/loop.hpp"

namespace spm::servo {

/// Whether the loop stood still before this tick or in it, so that guards sent the device zero, or
/// the machine has just slept. The device then gets its force back by the soft start.
bool Loop::was_stopped(const Channel& channel) const noexcept {
  const bool sleeping = settings_.sleeping != nullptr && settings_.sleeping->load();
  if (sleeping || last_woke_ < awake_from_) return true;
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

/// Why there is no force in this tick, as far as it is known before the force law is asked.
ForceOff Loop::cause_before_forces(Channel& channel, ForceOff device,
                                   const DeviceState& state) noexcept {
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
  return cause == ForceOff::none && channel.clutched ? ForceOff::clutched : cause;
}

void Loop::serve(Channel& channel, std::uint64_t tick, bool stopping) noexcept {
  DeviceState state;
  const DeviceHealth health = channel.read(state, tick);
  const HandPose hand{state.position, state.orientation};
  const ForceOff device = channel.off(health, hand, tick);
  // While a fault lasts nobody knows whether the clutch is held, and it stays as it was. Where an
  // application takes it the force fades first.
  const bool by_button = device == ForceOff::none && channel.is_clutched_by_button(state);
  const bool clutching =
      device == ForceOff::none ? by_button || channel.app_clutched : channel.clutched;
  channel.clutched = clutching && (channel.clutched || by_button || channel.safety.is_off());
  const HandPose tool = is_pose(hand) ? channel.clutch.tool_of(hand, channel.clutched) : hand;

  // Whatever the cause, the device is still read, and zero is sent to it.
  ForceOff cause = cause_before_forces(channel, device, state);
  if (cause == ForceOff::none && was_stopped(channel)) cause = ForceOff::stalled;
  cause = channel.unless_runaway(cause, hand, tick);
  TickRecord& record = channel.record;
  ContactForce contact;
  Wrench added;
  record.effort = {};
  const bool asked = cause == ForceOff::none;
  if (asked) channel.resume(tool);
  record.forgot = channel.forgot;
  if (asked) {
    channel.forgot = false;
    contact = channel.force.next(views_, tool, channel.ticks, budget_of(channel));
    record.effort = channel.force.effort();
    added = added_to(channel, tool.position);
    // A page of the asset may have been lost while the force was computed from it.
    cause = assets_off();
  }
  if (cause == ForceOff::none && was_stopped(channel)) cause = ForceOff::stalled;
  if (stopping) cause = ForceOff::stopping;
  if (cause != ForceOff::none) {
    contact = ContactForce{};
    added = {};
    if (app_) app_->effects().rest(record.device);
    channel.rest();
    // A force that nobody felt, and no recording tells, leaves nothing behind.
    if (asked) channel.forget();
  }

  const Wrench wanted{contact.force, contact.torque};
  const SafeWrench sent = channel.safety.apply(
      {wanted.force + added.force, wanted.torque + added.torque}, cause,
      clutching ? Fade::clutch : (app_silent_ ? Fade::silent : Fade::none), channel.ticks);
  channel.written = channel.device->write(sent.wrench());
  if (sent.cause == ForceOff::none) {
    channel.force.sent(contact_part(sent.wrench(), wanted, added));
  }
  channel.permission.sent(sent.cause);
  channel.runaway.sent(sent.force);

  record.hand = tool;
  record.wanted = wanted;
  record.added = added;
  record.sent = sent.wrench();
  record.buttons = state.buttons;
  record.depth = contact.depth;
  record.contact = contact.contact;
  record.cause = sent.cause;
  record.kept = cause == ForceOff::none && sent.cause != ForceOff::none;
  record.force_capped = sent.capped;
  record.torque_capped = sent.torque_capped;
  note_tool(channel);
  channel.account(device_counters_[record.device], sent);
  if (app_) tell(channel, state, health, contact, sent);
}

/// What the record tells of the tool. Without force it is where it was, and touches nothing.
void Loop::note_tool(Channel& channel) noexcept {
  TickRecord& record = channel.record;
  const bool felt = record.cause == ForceOff::none && channel.force.has_tool();
  record.patches = 0;
  record.tool_capped = record.tool_leaving = false;
  if (!felt) return;
  const ToolTick& tool = channel.force.tool();
  record.has_tool = true;
  record.tool = {tool.pose.translation(), Eigen::Quaterniond(tool.pose.linear())};
  record.patches = static_cast<std::uint16_t>(tool.patch_count);
  record.tool_capped = tool.capped;
  record.tool_leaving = tool.leaving;
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

}  // namespace spm::servo
