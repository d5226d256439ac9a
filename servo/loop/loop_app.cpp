// SPDX-License-Identifier: Apache-2.0
// The part of the loop that serves applications.
#include <algorithm>

#include "servo/loop/loop.hpp"

namespace spm::servo {

void Loop::begin_app(std::int64_t now_ns) noexcept {
  if (!app_) return;
  const AppChanges changes = app_->begin(now_ns, forces_);
  app_silent_ = changes.silent;
  follow_stiffness(changes.stiffest * settings_.scene.workspace.scale);
  for (Channel& channel : channels_) {
    channel.record.touched = changes.touched;
    const std::uint32_t device = channel.record.device;
    channel.app_clutched = changes.clutches->held(device);
    lead(channel, changes.hands->of(device, now_ns));
    channel.acknowledged = device < SPM_MAX_DEVICES && ((changes.acknowledged >> device) & 1U) != 0;
    channel.safety.set_force_cap(std::min(channel.force_cap, changes.force_caps->of(device)));
  }
}

/// Tells a device where an application leads its hand, in the hand's frame.
void Loop::lead(Channel& channel, const HandPose* world) noexcept {
  channel.led = world != nullptr;
  if (world == nullptr) return channel.device->lead(nullptr);
  const Placement& workspace = settings_.scene.workspace;
  const HandPose hand{workspace.from_world(world->position),
                      workspace.rotation.conjugate() * world->orientation};
  channel.device->lead(&hand);
}

/// Sets the slew limit for the stiffness that is felt now, after an edit or a command of an
/// application.
void Loop::follow_stiffness(double stiffness) noexcept {
  if (stiffness == stiffness_) return;
  stiffness_ = stiffness;
  for (Channel& channel : channels_) channel.feel(stiffness, settings_.rate_hz);
}

/// Effects of applications count with the same delay as the objects.
void Loop::tell_effects(const Channel& channel) noexcept {
  const double tick = 1 / settings_.rate_hz;
  const ForceDevice kind = force_device(channel.device->capabilities());
  const double stable =
      std::min(kind.stiffness_cap, felt_limits(kind, tick).stable * channel.force.stable_share());
  app_->effects().set_delay(channel.record.device, channel.force.total_delay(),
                            stable / settings_.scene.workspace.scale);
}

void Loop::end_app(std::uint64_t tick, std::int64_t now_ns) noexcept {
  if (app_) app_->end(tick, now_ns, published_, forces_);
}

/// Publishes the counts to applications, now that the tick's length is known.
void Loop::tell_counts(std::int64_t woke, std::int64_t wake_ns, std::int64_t busy_ns) noexcept {
  if (!app_) return;
  app_->count({woke, wake_ns, busy_ns, counters_.ticks, counters_.missed, counters_.skipped,
               device_counters_, counters_.degraded_ticks});
}

/// Prepares what applications learn of a device, in the world's frame.
void Loop::tell(Channel& channel, const DeviceState& state, DeviceHealth health,
                const ContactForce& contact, const SafeWrench& sent) noexcept {
  const Placement& workspace = settings_.scene.workspace;
  const TickRecord& record = channel.record;
  AppDevice& published = published_[record.device];
  published.health = health;
  published.cause = sent.cause;
  published.contact = record.contact;
  published.depth = record.depth;
  published.wrench = {workspace.rotation * sent.force, workspace.rotation * sent.torque};
  published.state.buttons = state.buttons;
  published.force_cap = channel.safety.force_cap();
  published.torque_cap = channel.safety.torque_cap();
  published.force_capped = record.force_capped;
  published.torque_capped = record.torque_capped;
  published.leadable = channel.device->capabilities().led;
  published.led = channel.led;
  published.level = record.effort.level;
  published.culled = record.effort.culled;
  tell_tool(channel, published);
  if (health != DeviceHealth::ok || !is_pose(record.hand)) {
    // The last known pose is kept.
    channel.motion.reset();
    published.velocity.setZero();
    published.angular_velocity.setZero();
    return;
  }
  channel.motion.take(record.hand, channel.ticks);
  published.state.position = workspace.to_world(record.hand.position);
  published.state.orientation = workspace.rotation * record.hand.orientation;
  published.proxy = {
      published.state.position + contact.depth * (workspace.rotation * contact.normal),
      published.state.orientation};
  if (published.has_tool) published.proxy = hand_of_tool(record.tool, record.device);
  published.velocity = workspace.scale * (workspace.rotation * channel.motion.velocity());
  published.angular_velocity = workspace.rotation * channel.motion.angular_velocity();
}

/// Notes where a point or a ball touches: the strongest places, in the order of the objects.
std::span<const ContactPatch> Loop::touches(Channel& channel) noexcept {
  std::size_t count = 0;
  for (std::size_t i = 0; i < channel.force.size(); ++i) {
    const ContactPatch patch = channel.force.touch(i);
    if (patch.force.isZero(0)) continue;
    if (count < channel.touches.size()) {
      channel.touches[count++] = patch;
      continue;
    }
    const auto weakest = std::min_element(channel.touches.begin(), channel.touches.end(),
                                          [](const ContactPatch& a, const ContactPatch& b) {
                                            return a.force.norm() < b.force.norm();
                                          });
    if (weakest->force.norm() < patch.force.norm()) *weakest = patch;
  }
  return {channel.touches.data(), count};
}

/// The tool, and where it touches; without force it touches nothing.
void Loop::tell_tool(Channel& channel, AppDevice& published) noexcept {
  published.has_tool = channel.record.has_tool;
  published.tool_capped = channel.record.tool_capped;
  published.tool = channel.record.tool;
  published.patches = {};
  if (channel.record.patches > 0) published.patches = channel.force.tool().contacts();
  if (!channel.force.has_tool() && channel.record.contact) published.patches = touches(channel);
}

/// Where a hand would be that held the tool where it is, in the world.
HandPose Loop::hand_of_tool(const HandPose& tool, std::size_t device) const noexcept {
  const Placement& held = tool_of(settings_.scene, device)->placement;
  const Eigen::Quaterniond turn = tool.orientation * held.rotation.conjugate();
  return {tool.position - turn * held.position, turn};
}

/// What applications add to the wrench at the tool, N and N m about its origin, the hand's frame.
/// Each is held below its cap by itself, so that no push is as strong beside a contact as one that
/// would drown it.
Wrench Loop::added_to(Channel& channel, const Vector3& tool) noexcept {
  if (!app_) return {};
  const Placement& workspace = settings_.scene.workspace;
  const Wrench world = app_->effects().next(channel.record.device, workspace.to_world(tool),
                                            channel.ticks, last_woke_, channel.force, views_);
  const auto held = [&](const Vector3& wanted, double cap) -> Vector3 {
    const Vector3 added = workspace.rotation.conjugate() * wanted;
    const double size = added.norm();
    return size > cap ? Vector3(cap / size * added) : added;
  };
  return {held(world.force, channel.safety.force_cap()),
          held(world.torque, channel.safety.torque_cap())};
}

}  // namespace spm::servo
