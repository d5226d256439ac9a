// SPDX-License-Identifier: Apache-2.0
#include "servo/app/app_effects.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/base/smooth_change.hpp"

namespace spm::servo {

namespace {

/// Whether one effect goes over into another by its numbers.
bool is_alike(const HandEffect& one, const HandEffect& other) noexcept {
  return one.kind == other.kind && one.range == other.range && one.spacing == other.spacing;
}

/// Where an effect is: its point, with its axis as the z axis.
Placement place_of(const HandEffect& effect) noexcept {
  Placement place;
  place.position = effect.point;
  if (!effect.axis.isZero(0)) {
    place.rotation = Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), effect.axis);
  }
  return place;
}

/// From one limit of a force towards another, by at most `most`, N. From none it begins at the size
/// of what is held, and where none is wanted it ends once it holds nothing back.
void step_limit(double& limit, double wanted, double size, double most) noexcept {
  if (!std::isfinite(limit)) limit = std::isfinite(wanted) ? std::max(size, wanted) : limit;
  if (!std::isfinite(wanted)) {
    limit = size < limit ? wanted : limit + most;
  } else {
    limit += std::clamp(wanted - limit, -most, most);
  }
}

/// From one vector towards another, no farther than `most`.
Vector3 stepped_to(const Vector3& now, const Vector3& to, double most) noexcept {
  const Vector3 way = to - now;
  const double size = way.norm();
  return size > most ? Vector3(now + way * (most / size)) : to;
}

}  // namespace

void AppEffects::know_device(std::uint32_t device, const FeltLimits& bears, double encoder_step,
                             double tick, double delay_ticks) {
  Hand* const hand = find(device);
  if (hand == nullptr) return;
  hand->limits = {effects_stiffness_share * bears.stable, effects_damping_share * bears.damping};
  hand->whole = bears.stiffness;
  hand->tick = tick;
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
    effect.begun = effect.what;
    effect.wanted.damping = hand->leak * effect.wanted.stiffness;
  }
  settle(*hand);
}

/// Leaves to the effects what objects that are touched with `touched` N/m leave of the device's
/// stiffness. Without a step: a contact that begins moves no hand by an effect that ends.
void AppEffects::make_room(Hand& hand, double touched, double seconds) noexcept {
  const double room = std::max(hand.whole - touched, 0.0);
  const double wanted = hand.stiffness > room ? room / hand.stiffness : 1;
  const double most = change_share(seconds, 0);
  const auto follow = [most](double& share, double to) {
    share += std::clamp(to - share, -most, most);
  };
  follow(hand.left, wanted);
  follow(hand.felt_stiffness_share, hand.stiffness_share);
  follow(hand.felt_damping_share, hand.damping_share);
}

/// Computes what depends on all effects of a device. All that are set count, wherever the tool is:
/// a share that followed the tool would make steps.
void AppEffects::settle(Hand& hand) noexcept {
  double stiffness = 0, damping = 0;
  bool any = false;
  for (const Effect& effect : hand.effects) {
    if (effect.connection == 0) continue;
    any = true;
    const bool brakes = effect.wanted.kind == HandEffectKind::viscous;
    (brakes ? damping : stiffness) += brakes ? effect.wanted.damping : effect.wanted.stiffness;
  }
  hand.any = any;
  hand.stiffness_share = stiffness > hand.limits.stiffness ? hand.limits.stiffness / stiffness : 1;
  hand.stiffness = hand.stiffness_share * stiffness;
  hand.damping_share = damping > hand.limits.damping ? hand.limits.damping / damping : 1;
  if (!any) hand.velocity.reset();
}

void AppEffects::push(std::uint32_t device, std::uint32_t client, const Wrench& wrench,
                      std::int64_t until_ns) noexcept {
  Hand* const hand = find(device);
  if (hand == nullptr) return;
  hand->pushes[client].wrench = wrench;
  hand->pushes[client].until_ns = until_ns;
}

/// The place of an application's effect of that number, or one for a new effect; null where there
/// are most_effects. Of those that fade, the one that is felt least goes first.
AppEffects::Effect* AppEffects::place_for(Hand& hand, const AppCommand& command) noexcept {
  Effect* place = nullptr;
  std::size_t kept = 0;
  for (Effect& effect : hand.effects) {
    const bool here = effect.connection != 0 && !effect.leaving;
    if (here && effect.connection == command.connection && effect.number == command.effect_number) {
      return &effect;
    }
    kept += here ? 1 : 0;
    if (!here && (place == nullptr || effect.shown < place->shown)) place = &effect;
  }
  if (place == nullptr || kept >= most_effects) return nullptr;
  *place = {};
  return place;
}

Refusal AppEffects::set(const AppCommand& command, std::size_t object,
                        std::int64_t now_ns) noexcept {
  Hand* const hand = find(command.index);
  if (hand == nullptr) return Refusal::unknown_device;
  Effect* const place = place_for(*hand, command);
  if (place == nullptr) return Refusal::too_many_effects;
  HandEffect wanted = command.effect;
  // A spring that is sampled gives energy, so that a device left alone on it would swing ever more.
  if (wanted.kind != HandEffectKind::viscous) wanted.damping = hand->leak * wanted.stiffness;
  const bool is_new = place->connection == 0;
  place->connection = command.connection;
  place->number = command.effect_number;
  place->wanted = wanted;
  place->wanted_object = object;
  place->begun = place->what;
  settle(*hand);
  place->other = is_new || !is_alike(place->what, wanted) || place->object != object;
  if (!place->other) {
    place->motion.set_max_speed(change_rate / std::max(hand->stiffness, change_rate));
    place->motion.give(place_of(wanted), 0, now_ns);
  }
  return Refusal::none;
}

Refusal AppEffects::remove(const AppCommand& command) noexcept {
  Hand* const hand = find(command.index);
  if (hand == nullptr) return Refusal::unknown_device;
  const bool all = command.effect_number == SPM_ALL_EFFECTS;
  bool found = all;
  for (Effect& effect : hand->effects) {
    if (effect.connection == 0 || effect.leaving) continue;
    const bool own = effect.connection == command.connection;
    if (all ? !own && !command.supervisor : !own || effect.number != command.effect_number) {
      continue;
    }
    remove(effect);
    found = true;
  }
  return found ? Refusal::none : Refusal::unknown_effect;
}

void AppEffects::leave(std::uint32_t client, std::uint32_t connection) noexcept {
  for (Hand& hand : devices_) {
    hand.pushes[client].until_ns = 0;
    for (Effect& effect : hand.effects) {
      if (effect.connection == connection) remove(effect);
    }
  }
}

void AppEffects::drop(std::size_t object) noexcept {
  for (Hand& hand : devices_) {
    for (Effect& effect : hand.effects) {
      const bool felt = effect.what.kind == HandEffectKind::magnet && effect.object == object;
      const bool wanted =
          effect.wanted.kind == HandEffectKind::magnet && effect.wanted_object == object;
      // There is no surface any more to go by.
      if (felt) {
        hand.fading += effect.felt;
        effect.felt.setZero();
        effect.shown = 0;
      }
      if (wanted) remove(effect);
    }
  }
}

/// Takes what is felt of an effect nearer to what is wanted of it. `felt`: N, all that is felt of
/// effects.
void AppEffects::go_on(Hand& hand, Effect& effect, double seconds, double felt,
                       std::int64_t now_ns) noexcept {
  const double share = change_share(seconds, felt);
  const bool fades = effect.leaving || effect.silent || effect.other;
  effect.shown = std::clamp(effect.shown + (fades ? -share : share), 0.0, 1.0);
  if (effect.shown == 0 && effect.leaving) {
    effect = {};
    settle(hand);
    return;
  }
  if (effect.shown == 0 && effect.other) {
    effect.what = effect.begun = effect.wanted;
    effect.object = effect.wanted_object;
    effect.motion = PoseInterpolator({}, place_of(effect.wanted));
    effect.other = false;
    return;
  }
  if (effect.other) return;
  HandEffect& what = effect.what;
  const HandEffect& begun = effect.begun;
  const HandEffect& wanted = effect.wanted;
  const double stiffer = felt > 0 ? change_rate * seconds * what.stiffness / felt
                                  : std::numeric_limits<double>::infinity();
  what.stiffness = stepped(what.stiffness, begun.stiffness, wanted.stiffness, share, stiffer);
  what.damping =
      stepped(what.damping, begun.damping, wanted.damping, share, wanted.damping + what.damping);
  step_limit(what.most_force, wanted.most_force, effect.size, change_rate * seconds);
  if (what.kind == HandEffectKind::spring || what.kind == HandEffectKind::detents) {
    const Placement place = effect.motion.at(now_ns).pose;
    what.point = place.position;
    what.axis = wanted.axis.isZero(0) ? wanted.axis : Vector3(place.rotation * Vector3::UnitZ());
  }
}

Wrench AppEffects::next(std::uint32_t device, const Vector3& tool, std::uint64_t ticks,
                        std::int64_t now_ns, const SceneForce& force,
                        std::span<const AssetView* const> assets) noexcept {
  Hand* const found = find(device);
  if (found == nullptr || !tool.allFinite()) return {};
  Hand& hand = *found;
  const double seconds = static_cast<double>(ticks) * hand.tick;
  const double most = change_rate * seconds;
  Wrench sum;
  for (Push& push : hand.pushes) {
    const bool over = now_ns >= push.until_ns;
    if (over && push.felt.force.isZero(0) && push.felt.torque.isZero(0)) continue;
    push.felt.force = stepped_to(push.felt.force, over ? Vector3::Zero() : push.wrench.force, most);
    push.felt.torque = stepped_to(push.felt.torque, over ? Vector3::Zero() : push.wrench.torque,
                                  finger_arm * most);
    sum.force += push.felt.force;
    sum.torque += push.felt.torque;
  }
  hand.fading = stepped_to(hand.fading, Vector3::Zero(), most);
  sum.force += hand.fading;
  if (hand.any) hand.velocity.take(tool, ticks);
  const Vector3 velocity = hand.any ? hand.velocity.now() : Vector3::Zero();
  make_room(hand, force.touched_stiffness(), seconds);
  double felt = 0;
  for (Effect& effect : hand.effects) {
    if (effect.connection == 0) continue;
    go_on(hand, effect, seconds, hand.felt, now_ns);
    if (effect.connection == 0) continue;
    const HandEffectKind kind = effect.what.kind;
    const NearSurface surface = kind == HandEffectKind::magnet
                                    ? force.near_surface(effect.object, assets, tool)
                                    : NearSurface{};
    const double share = kind == HandEffectKind::viscous ? hand.felt_damping_share
                                                         : hand.left * hand.felt_stiffness_share;
    const Vector3 whole = hand_effect_force(effect.what, tool, velocity, surface);
    const double brake = kind == HandEffectKind::viscous ? 0 : effect.what.damping;
    effect.size = whole.norm() + brake * velocity.norm();
    felt += share * whole.norm();
    effect.felt = effect.shown * share * whole;
    sum.force += effect.felt;
  }
  hand.felt = felt;
  return sum.force.allFinite() && sum.torque.allFinite() ? sum : Wrench{};
}

void AppEffects::rest(std::uint32_t device) noexcept {
  Hand* const hand = find(device);
  if (hand == nullptr) return;
  hand->velocity.reset();
  hand->felt = 0;
  hand->fading.setZero();
  for (Push& push : hand->pushes) push.felt = {};
  for (Effect& effect : hand->effects) effect.shown = 0;
}

}  // namespace spm::servo
