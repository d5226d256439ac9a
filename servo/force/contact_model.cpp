// SPDX-License-Identifier: Apache-2.0
#include "servo/force/contact_model.hpp"

#include <cmath>

#include "common/paper/map_noise.hpp"
#include "common/paper/paper_effects.hpp"

namespace spm {

namespace {

/// The contact that eq. 17 and 19 are of. For a probe with a size S_SP - D_SP is the mean that its
/// force came from, and the plane is that of its centre.
PaperContact paper_place(const AssetView& asset, const ForceSettings& force, const Vector3& point,
                         const ContactForce& contact) noexcept {
  if (!(force.probe_radius > 0)) return paper_contact(asset, point, force.rule);
  PaperContact found;
  found.contact = contact.contact;
  found.plane = static_cast<std::uint32_t>(closest_support_plane(asset, point));
  found.plane_depth = found.depth = contact.depth;
  found.normal = contact.normal;
  return found;
}

}  // namespace

ContactModel::ContactModel(const ContactSettings& settings) noexcept
    : settings_(settings),
      velocity_(settings.encoder_step, settings.tick, settings.velocity),
      coupling_(settings.coupling, settings.force.stiffness, settings.tick),
      lattice_(settings.potential) {
  settings_.force.stiffness = coupling_.felt();
}

void ContactModel::reset() noexcept {
  rest();
  proxy_ = {};
}

void ContactModel::rest() noexcept {
  friction_ = {};
  velocity_.reset();
  coupling_.reset();
  lattice_.forget();
  last_normal_.setZero();
  held_.contact = false;
  care_ = Care::exact;
  last_known_ = false;
}

void ContactModel::continue_from(const ContactModel& other) noexcept {
  proxy_ = other.proxy_;
  friction_ = other.friction_;
  last_point_ = other.last_point_;
  last_normal_ = other.last_normal_;
  last_turned_at_ = other.last_turned_at_;
  last_known_ = other.last_known_;
  held_ = other.held_;
  held_at_ = other.held_at_;
  coupling_.continue_from(other.coupling_);
  if (settings_.velocity == other.settings_.velocity) velocity_ = other.velocity_;
}

ContactForce ContactModel::next(const AssetView& asset, const Vector3& point, std::uint64_t ticks,
                                bool exact) noexcept {
  const bool usable = settings_.force.stiffness >= 0 && std::isfinite(settings_.force.stiffness);
  if (!point.allFinite() || !usable) {
    reset();
    return {};
  }
  const ForceSettings& force = settings_.force;
  ContactForce contact = surface(asset, point, exact);
  if (settings_.effects.any() && force.stiffness > 0) add_effects(asset, point, ticks, contact);
  if (coupling_.on()) contact.force += coupling_.damped(contact.depth * contact.normal);
  if (!contact.force.allFinite()) {
    reset();
    return {};
  }
  return contact;
}

/// The force of the surface alone, exact or not.
ContactForce ContactModel::surface(const AssetView& asset, const Vector3& point,
                                   bool exact) noexcept {
  const ForceSettings& force = settings_.force;
  care_ = Care::exact;
  const bool is_held =
      !exact && held_.contact && (force.method != Method::paper || !settings_.effects.any());
  if (is_held) return held_force(point);
  ContactForce contact = reaction(asset, point, exact);
  if (force.method == Method::spm && settings_.effects.turn.rate > 0) limit_turn(point, contact);
  held_ = contact;
  held_at_ = point;
  return contact;
}

/// The force of the plane that was touched last. It goes on from the last force, since only the
/// depth under the plane changes. Once left, the plane is forgotten.
ContactForce ContactModel::held_force(const Vector3& point) noexcept {
  care_ = Care::held;
  ContactForce contact = held_;
  contact.depth -= (point - held_at_).dot(held_.normal);
  if (!(contact.depth > 0)) {
    held_.contact = false;
    last_normal_.setZero();
    return {};
  }
  contact.force = settings_.force.stiffness * contact.depth * contact.normal;
  return contact;
}

/// The force at a point by the chosen method.
ContactForce ContactModel::reaction(const AssetView& asset, const Vector3& point,
                                    bool exact) noexcept {
  const ForceSettings& force = settings_.force;
  if (force.method == Method::proxy) return proxy_force(asset, point, exact);
  if (force.method != Method::spm) return contact_force(asset, force, point);
  const RuntimeSmoothing& smoothing = settings_.effects.smoothing;
  if (lattice_.on()) {
    const auto contact = lattice_.force(asset, force, smoothing, point);
    if (contact) return *contact;
  }
  return smoothing.sigma > 0 ? smoothed_force(asset, force, smoothing, point)
                             : contact_force(asset, force, point);
}

void ContactModel::limit_turn(const Vector3& point, ContactForce& contact) noexcept {
  const TurnLimit& turn = settings_.effects.turn;
  const bool is_near = (point - last_turned_at_).squaredNorm() <= turn.step * turn.step;
  last_turned_at_ = point;
  if (contact.contact && !last_normal_.isZero(0) && is_near) {
    contact.normal =
        limited_turn(last_normal_, contact.normal, turn.rate * settings_.tick, turn.jump);
    contact.force = settings_.force.stiffness * contact.depth * contact.normal;
  }
  last_normal_ = contact.contact ? contact.normal : Vector3::Zero();
}

ContactForce ContactModel::proxy_force(const AssetView& asset, const Vector3& point,
                                       bool exact) noexcept {
  const ForceSettings& force = settings_.force;
  const std::uint32_t most = exact ? proxy_queries : proxy_few_queries;
  const ProxyContact found = move_proxy(asset, force.probe_radius, point, proxy_, most);
  if (!exact && found.queries >= most) care_ = Care::shortened;
  ContactForce contact;
  if (!found.contact) return contact;
  contact.contact = true;
  contact.depth = found.depth;
  contact.normal = found.normal;
  contact.force = force.stiffness * found.depth * found.normal;
  return contact;
}

void ContactModel::add_effects(const AssetView& asset, const Vector3& point, std::uint64_t ticks,
                               ContactForce& contact) noexcept {
  const EffectSettings& effects = settings_.effects;
  const Vector3 velocity = velocity_.next(point, ticks);
  const Vector3 motion = last_known_ ? Vector3(point - last_point_) : Vector3::Zero();
  last_point_ = point;
  last_known_ = true;
  if (!contact.contact) {
    friction_ = {};
    return;
  }
  if (settings_.force.method == Method::paper) {
    add_paper_effects(asset, point, motion, ticks, contact);
    return;
  }
  Vector3 reaction = contact.force;
  if (effects.texture.amplitude > 0) {
    const TextureHeight texture =
        texture_at(effects.texture, point + contact.depth * contact.normal);
    reaction = textured_force(settings_.force.stiffness, contact.depth, contact.normal, texture);
  }
  const double pressing = reaction.dot(contact.normal);
  const Vector3 friction =
      coulomb_friction(effects.friction, point, contact.normal, pressing, friction_);
  contact.force = haptic_force(reaction, friction, paper_damping(effects.damping, velocity));
}

void ContactModel::add_paper_effects(const AssetView& asset, const Vector3& point,
                                     const Vector3& motion, std::uint64_t ticks,
                                     ContactForce& contact) noexcept {
  const EffectSettings& effects = settings_.effects;
  const PaperContact found = paper_place(asset, settings_.force, point, contact);
  Vector3 reaction = contact.force;
  if (effects.texture_noise > 0) {
    const double noise =
        effects.texture_noise * map_noise(asset, found.plane, point, effects.noise_seed);
    reaction = paper_texture_force(settings_.force.stiffness, found, noise);
  }
  // P_M, the projection on the plane, moves by the component of the motion along the plane.
  const Vector3& normal = asset.planes[found.plane].n;
  const Vector3 along = motion - motion.dot(normal) * normal;
  contact.force = haptic_force(
      reaction, paper_friction(effects.friction_force, effects.friction_depth, found, motion),
      paper_damping(effects.damping, along / (settings_.tick * static_cast<double>(ticks))));
}

}  // namespace spm
