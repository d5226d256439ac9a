// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/channel.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "common/base/turn_between.hpp"

namespace spm::servo {

namespace {

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
    case DeviceHealth::unconfirmed:
      return ForceOff::unconfirmed;
  }
  return ForceOff::device_fault;
}

/// N m: the device's, and no more than the scene's tool may.
double torque_cap(const DeviceCapabilities& device, const LoopSettings& settings,
                  std::size_t number) {
  const double own = hand_turning(device).torque_cap;
  const ToolSettings* tool = tool_of(settings.scene, number);
  return tool != nullptr ? std::min(own, tool->torque_cap) : own;
}

/// One of no known kind is taken for the lightest: a heavier one runs away more slowly, and alike.
RunawaySettings runaway_settings(const DeviceCapabilities& device, double tick) {
  const DeviceProfile* profile = device.profile != nullptr ? device.profile : &worst_device_profile;
  return {device.force_cap > 0 ? profile->moving_mass : 0, device.encoder_step, tick};
}

}  // namespace

SafetySettings device_limits(const DeviceCapabilities& device, const LoopSettings& settings,
                             std::size_t number) {
  const double stiffness = std::min(stiffness_at_hand(settings.scene), device.stiffness_cap);
  return safety_settings(std::min(device.force_cap, settings.force_cap), stiffness,
                         settings.rate_hz, torque_cap(device, settings, number));
}

HandTurning turning_in_run(const DeviceCapabilities& device, const LoopSettings& settings,
                           std::size_t number) {
  HandTurning turning = hand_turning(device);
  const double force = std::min(device.force_cap, settings.force_cap);
  turning.force_cap = force > 0 ? force : std::numeric_limits<double>::infinity();
  turning.torque_cap = torque_cap(device, settings, number);
  return turning;
}

HandPose Clutch::tool_of(const HandPose& hand, bool held) noexcept {
  if (held) {
    way_ = tool_.position - hand.position;
    turn_ = (hand.orientation.conjugate() * tool_.orientation).normalized();
    return tool_;
  }
  tool_.position = hand.position + way_;
  // Without a clutch the orientation is the hand's to the last bit.
  const bool same = turn_.coeffs() == Eigen::Quaterniond::Identity().coeffs();
  tool_.orientation = same ? hand.orientation : (hand.orientation * turn_).normalized();
  return tool_;
}

void HandVelocity::take(const HandPose& hand, std::uint64_t ticks) noexcept {
  if (last_known_) turned_ += turn_between(last_, hand.orientation);
  last_ = hand.orientation;
  last_known_ = true;
  now_ = velocity_.next(hand.position, ticks);
  turning_now_ = turning_.next(turned_, ticks);
}

void HandVelocity::reset() noexcept {
  velocity_.reset();
  turning_.reset();
  last_known_ = false;
  now_.setZero();
  turning_now_.setZero();
}

double WorkAccount::next(const HandPose& hand, const Wrench& sent) noexcept {
  double work = 0;
  if (is_pose(hand)) {
    if (last_known_) {
      work = sent_.force.dot(hand.position - last_.position) +
             sent_.torque.dot(turn_between(last_.orientation, hand.orientation));
    }
    last_ = hand;
    last_known_ = true;
  }
  sent_ = sent;
  return work;
}

Channel::Channel(Device* driven, const LoopSettings& settings, std::size_t room, std::size_t number)
    : device(driven),
      safety(device_limits(driven->capabilities(), settings, number)),
      gate(settings.rate_hz),
      runaway(runaway_settings(driven->capabilities(), 1 / settings.rate_hz)),
      permission(
          {settings.acknowledge, settings.enable_button, driven->capabilities().clutch_button}),
      force(settings.scene, 1 / settings.rate_hz, driven->capabilities().encoder_step, room,
            felt_limits(force_device(driven->capabilities()), 1 / settings.rate_hz),
            turning_in_run(driven->capabilities(), settings, number), number),
      force_cap(safety.force_cap()),
      motion(driven->capabilities().encoder_step, driven->capabilities().turn_step,
             1 / settings.rate_hz),
      delay(1 / settings.rate_hz, driven->capabilities().own_delay) {}

DeviceHealth Channel::read(DeviceState& state, std::uint64_t tick) noexcept {
  const DeviceHealth health = device->read(state);
  if (health == DeviceHealth::ok || health == DeviceHealth::unconfirmed) {
    believed = {state.position, state.orientation};
  } else {
    state.position = believed.position;
    state.orientation = believed.orientation;
  }
  ticks = tick > last_tick ? tick - last_tick : 1;
  last_tick = tick;
  return health;
}

ForceOff Channel::off(DeviceHealth health, const HandPose& hand, std::uint64_t tick) noexcept {
  ForceOff cause = cause_of(health);
  if (cause == ForceOff::none) cause = cause_of(written);
  if (cause == ForceOff::none && !is_pose(hand)) cause = ForceOff::not_a_number;
  if (cause == ForceOff::none && is_outside(hand.position, device->capabilities().workspace)) {
    cause = ForceOff::outside_workspace;
  }
  if (cause != ForceOff::none) {
    gate.forget();
    return cause;
  }
  return gate.jumped(hand, tick) ? ForceOff::jumped : ForceOff::none;
}

ForceOff Channel::unless_runaway(ForceOff cause, const HandPose& hand,
                                 std::uint64_t tick) noexcept {
  if (cause != ForceOff::none) {
    runaway.forget();
    return cause;
  }
  const bool runs = runaway.runs_away(hand.position, tick, safety.force_cap());
  return runs ? ForceOff::runaway : ForceOff::none;
}

bool Channel::is_clutched_by_button(const DeviceState& state) const noexcept {
  const std::uint32_t button = device->capabilities().clutch_button;
  return button > 0 && ((state.buttons >> (button - 1)) & 1U) != 0;
}

void Channel::account(DeviceCounters& counters, const SafeWrench& sent) noexcept {
  if (record.cause == ForceOff::jumped) work.forget();
  counters.energy += work.next(record.hand, sent.wrench());
  counters.generated_max = std::max(counters.generated_max, counters.energy);
  counters.contact_ticks += record.contact ? 1 : 0;
  const ForceEffort& effort = record.effort;
  counters.degraded_ticks += effort.degraded() ? 1 : 0;
  counters.held += effort.held;
  counters.shortened += effort.shortened;
  counters.coarse += effort.level > 0 ? 1 : 0;
  counters.cap_hits += sent.capped ? 1 : 0;
  counters.slew_hits += sent.slewed ? 1 : 0;
  counters.torque_cap_hits += sent.torque_capped ? 1 : 0;
  counters.torque_slew_hits += sent.torque_slewed ? 1 : 0;
  counters.tool_leaving += record.tool_leaving ? 1 : 0;
  counters.tool_cap_hits += record.tool_capped ? 1 : 0;
  counters.force_max = std::max(counters.force_max, sent.force.norm());
  counters.torque_max = std::max(counters.torque_max, sent.torque.norm());
  if (sent.cause != ForceOff::none) ++counters.force_off[static_cast<std::size_t>(sent.cause)];
}

void Channel::forget() noexcept {
  force.reset();
  forgot = true;
}

void Channel::rest() noexcept {
  force.rest();
  resting = true;
}

void Channel::resume(const HandPose& tool) noexcept {
  const bool same = (tool.position - left_at.position).norm() <= kept_way &&
                    (!force.has_tool() ||
                     turn_between(left_at.orientation, tool.orientation).norm() <= kept_turn);
  if (std::exchange(resting, false) && !same) forget();
  left_at = tool;
}

void Channel::feel(double stiffness, double rate_hz) noexcept {
  const double force_slew =
      slew_limit(std::min(stiffness, device->capabilities().stiffness_cap), rate_hz);
  safety.set_slew_limits(force_slew, torque_slew_limit(force_slew, arm));
}

}  // namespace spm::servo
