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
    if (changes.felt_anew) channel.safety.restart();
    channel.record.touched = changes.touched;
    const std::uint32_t device = channel.record.device;
    channel.app_clutched = changes.clutches->held(device);
    channel.acknowledged = device < SPM_MAX_DEVICES && ((changes.acknowledged >> device) & 1U) != 0;
    channel.safety.set_force_cap(std::min(channel.force_cap, changes.force_caps->of(device)));
  }
}

/// Sets the slew limit for the stiffness that is felt now, after an edit or a command of an
/// application.
void Loop::follow_stiffness(double stiffness) noexcept {
  if (stiffness == stiffness_) return;
  stiffness_ = stiffness;
  for (Channel& channel : channels_) {
    const double felt = std::min(stiffness, channel.device->capabilities().stiffness_cap);
    channel.safety.set_slew_limit(slew_limit(felt, settings_.rate_hz));
  }
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
                const ContactForce& contact, const SafeForce& sent) noexcept {
  const Placement& workspace = settings_.scene.workspace;
  AppDevice& published = published_[channel.record.device];
  published.health = health;
  published.cause = sent.cause;
  published.contact = channel.record.contact;
  published.depth = channel.record.depth;
  published.wrench = {workspace.rotation * sent.force, Vector3::Zero()};
  published.state.buttons = state.buttons;
  published.force_cap = channel.safety.force_cap();
  if (health != DeviceHealth::ok || !channel.record.position.allFinite()) {
    // The last known position is kept.
    channel.velocity.reset();
    published.velocity.setZero();
    return;
  }
  published.state.position = workspace.to_world(channel.record.position);
  published.state.orientation = workspace.rotation * state.orientation;
  published.proxy =
      published.state.position + contact.depth * (workspace.rotation * contact.normal);
  published.velocity =
      workspace.scale *
      (workspace.rotation * channel.velocity.next(channel.record.position, channel.ticks));
}

/// What applications add to the force at the tool, N, the hand's frame. It is held below the cap by
/// itself, so that no push is as strong beside a contact as one that would drown it.
Vector3 Loop::added_to(Channel& channel, const Vector3& tool) noexcept {
  if (!app_) return Vector3::Zero();
  const Placement& workspace = settings_.scene.workspace;
  const Vector3 world = app_->effects().next(channel.record.device, workspace.to_world(tool),
                                             channel.ticks, last_woke_, channel.force, views_);
  const Vector3 added = workspace.rotation.conjugate() * world;
  const double cap = channel.safety.force_cap(), size = added.norm();
  return size > cap ? Vector3(cap / size * added) : added;
}

}  // namespace spm::servo
