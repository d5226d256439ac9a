// SPDX-License-Identifier: Apache-2.0
#include "servo/app/app_effects.hpp"

#include <algorithm>
#include <utility>

namespace spm::servo {

void AppEffects::know_device(std::uint32_t device, const FeltLimits& bears, double encoder_step,
                             double tick, double delay_ticks) {
  Hand* const hand = find(device);
  if (hand == nullptr) return;
  hand->limits = {effects_stiffness_share * bears.stable, effects_damping_share * bears.damping};
  hand->whole = bears.stiffness;
  hand->tick = tick;
  hand->fade_step = std::min(1.0, tick / effect_fade);
  hand->leak = matched_damping(1, 1, delay_ticks, tick);
  hand->velocity = BrakingVelocity(encoder_step, tick);
}

void AppEffects::set_delay(std::uint32_t device, double delay_ticks, double stable) noexcept {
  Hand* const hand = find(device);
  if (hand == nullptr) return;
  hand->limits.stiffness = effects_stiffness_share * stable;
  hand->leak = matched_damping(1, 1, delay_ticks, hand->tick);
  for (Effect& effect : hand->effects) {
    if (effect.connection == 0 || effect.what.kind == HandEffectKind::viscous) continue;
    effect.what.damping = hand->leak * effect.what.stiffness;
  }
  settle(*hand);
}

/// Leaves to the effects what objects that are touched with `touched` N/m leave of the device's
/// stiffness. Without a step: a contact that begins moves no hand by an effect that ends.
void AppEffects::make_room(Hand& hand, double touched, std::uint64_t ticks) noexcept {
  const double room = std::max(hand.whole - touched, 0.0);
  const double wanted = hand.stiffness > room ? room / hand.stiffness : 1;
  const double most = hand.fade_step * static_cast<double>(ticks);
  hand.left += std::clamp(wanted - hand.left, -most, most);
}

/// Computes what depends on all effects of a device. All that are set count, wherever the tool is:
/// a share that followed the tool would make steps.
void AppEffects::settle(Hand& hand) noexcept {
  double stiffness = 0, damping = 0;
  bool any = false;
  for (const Effect& effect : hand.effects) {
    if (effect.connection == 0) continue;
    any = true;
    const bool brakes = effect.what.kind == HandEffectKind::viscous;
    (brakes ? damping : stiffness) += brakes ? effect.what.damping : effect.what.stiffness;
  }
  hand.any = any;
  hand.stiffness_share = stiffness > hand.limits.stiffness ? hand.limits.stiffness / stiffness : 1;
  hand.stiffness = hand.stiffness_share * stiffness;
  hand.damping_share = damping > hand.limits.damping ? hand.limits.damping / damping : 1;
  if (!any) hand.velocity.reset();
}

void AppEffects::push(std::uint32_t device, std::uint32_t client, const Wrench& wrench,
                      std::int64_t until_ns) noexcept {
  if (Hand* const hand = find(device)) hand->pushes[client] = {wrench, until_ns};
}

Refusal AppEffects::set(const AppCommand& command, std::size_t object) noexcept {
  Hand* const hand = find(command.index);
  if (hand == nullptr) return Refusal::unknown_device;
  Effect* place = nullptr;
  for (Effect& effect : hand->effects) {
    const bool same =
        effect.connection == command.connection && effect.number == command.effect_number;
    if (same) place = &effect;
    if (same) break;
    if (effect.connection == 0 && place == nullptr) place = &effect;
  }
  if (place == nullptr) return Refusal::too_many_effects;
  const bool goes_on = place->connection != 0 && place->what.kind == command.effect.kind;
  *place = {command.connection, command.effect_number, command.effect, object,
            goes_on ? place->shown : 0};
  // A spring that is sampled gives energy, so that a device left alone on it would swing ever more.
  if (command.effect.kind != HandEffectKind::viscous) {
    place->what.damping = hand->leak * command.effect.stiffness;
  }
  settle(*hand);
  return Refusal::none;
}

Refusal AppEffects::remove(const AppCommand& command) noexcept {
  Hand* const hand = find(command.index);
  if (hand == nullptr) return Refusal::unknown_device;
  const bool all = command.effect_number == SPM_ALL_EFFECTS;
  bool found = all;
  for (Effect& effect : hand->effects) {
    const bool own = effect.connection == command.connection;
    if (all ? !own && !command.supervisor : !own || effect.number != command.effect_number) {
      continue;
    }
    effect = {};
    found = true;
  }
  settle(*hand);
  return found ? Refusal::none : Refusal::unknown_effect;
}

void AppEffects::leave(std::uint32_t client, std::uint32_t connection) noexcept {
  for (Hand& hand : devices_) {
    hand.pushes[client] = {};
    for (Effect& effect : hand.effects) {
      if (effect.connection == connection) effect = {};
    }
    settle(hand);
  }
}

void AppEffects::drop(std::size_t object) noexcept {
  for (Hand& hand : devices_) {
    for (Effect& effect : hand.effects) {
      const bool magnet = effect.what.kind == HandEffectKind::magnet;
      if (magnet && effect.object == object) effect = {};
    }
    settle(hand);
  }
}

Wrench AppEffects::next(std::uint32_t device, const Vector3& tool, std::uint64_t ticks,
                        std::int64_t now_ns, const SceneForce& force,
                        std::span<const AssetView* const> assets) noexcept {
  Hand* const found = find(device);
  if (found == nullptr || !tool.allFinite()) return {};
  Hand& hand = *found;
  Wrench sum;
  for (const Push& push : hand.pushes) {
    if (now_ns >= push.until_ns) continue;
    sum.force += push.wrench.force;
    sum.torque += push.wrench.torque;
  }
  if (hand.any) hand.velocity.take(tool, ticks);
  const Vector3 velocity = hand.any ? hand.velocity.now() : Vector3::Zero();
  make_room(hand, force.touched_stiffness(), ticks);
  for (Effect& effect : hand.effects) {
    if (effect.connection == 0) continue;
    const HandEffectKind kind = effect.what.kind;
    const NearSurface surface = kind == HandEffectKind::magnet
                                    ? force.near_surface(effect.object, assets, tool)
                                    : NearSurface{};
    effect.shown = std::min(1.0, effect.shown + hand.fade_step * static_cast<double>(ticks));
    const double share =
        kind == HandEffectKind::viscous ? hand.damping_share : hand.left * hand.stiffness_share;
    sum.force += effect.shown * share * hand_effect_force(effect.what, tool, velocity, surface);
  }
  return sum.force.allFinite() && sum.torque.allFinite() ? sum : Wrench{};
}

void AppEffects::rest(std::uint32_t device) noexcept {
  Hand* const hand = find(device);
  if (hand == nullptr) return;
  hand->velocity.reset();
  for (Effect& effect : hand->effects) effect.shown = 0;
}

}  // namespace spm::servo
