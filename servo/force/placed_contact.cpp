// SPDX-License-Identifier: Apache-2.0
#include "servo/force/placed_contact.hpp"

#include <algorithm>
#include <cmath>

#include "common/query/query.hpp"

namespace spm {

namespace {

/// Distance of the farthest sample of the smoothing kernel, in sigmas.
constexpr double kernel_radius = 2.5;

}  // namespace

ContactSettings in_asset_frame(const PlacedObject& object, double tick, double encoder_step,
                               const CouplingSettings& coupling, VelocityMethod velocity,
                               double potential) noexcept {
  const double scale = object.placement.scale;
  ContactSettings settings{object.force, object.effects,   tick, encoder_step / scale, coupling,
                           velocity,     potential / scale};
  settings.coupling.stiffness *= scale;
  settings.coupling.damping *= scale;
  settings.force.stiffness *= scale;
  settings.force.probe_radius /= scale;
  settings.force.probe_length /= scale;
  EffectSettings& effects = settings.effects;
  effects.friction.stiffness *= scale;
  effects.damping *= scale;
  effects.texture.amplitude /= scale;
  effects.texture.wavelength /= scale;
  effects.smoothing.sigma /= scale;
  effects.friction_depth *= scale;
  effects.texture_noise /= scale;
  return settings;
}

PlacedContact::PlacedContact(const PlacedObject& object, double tick, double encoder_step,
                             const CouplingSettings& coupling, VelocityMethod velocity,
                             double potential) noexcept
    : asset_(object.asset),
      rotation_(object.placement.rotation.toRotationMatrix()),
      position_(object.placement.position),
      seat_rotation_(rotation_),
      seat_(position_),
      scale_(object.placement.scale),
      turns_(object.force.probe_length > 0),
      probe_axis_(object.force.probe_axis),
      // An asset's band reaches as far as the probe's radius.
      contact_margin_(
          (kernel_radius * object.effects.smoothing.sigma + object.force.probe_length / 2) /
          object.placement.scale),
      // Of the paper's rules this one may find contact anywhere.
      may_skip_(object.force.method != Method::paper ||
                object.force.rule != PaperRule::closest_surface),
      model_(in_asset_frame(object, tick, encoder_step, coupling, velocity, potential)) {}

void PlacedContact::reset() noexcept {
  model_.reset();
  last_known_ = touching_ = away_ = false;
}

void PlacedContact::continue_from(const PlacedContact& other) noexcept {
  if (asset_ != other.asset_ || scale_ != other.scale_ ||
      model_.settings().force.method != other.model_.settings().force.method) {
    return;
  }
  model_.continue_from(other.model_);
  last_ = other.last_;
  last_known_ = other.last_known_;
  touching_ = other.touching_;
  away_ = other.away_;
}

double PlacedContact::friction_stiffness() const noexcept {
  const FrictionSettings& friction = model_.settings().effects.friction;
  return std::max(friction.stick, friction.slide) > 0 ? friction.stiffness / scale_ : 0;
}

Vector3 PlacedContact::carried(const Vector3& point) noexcept {
  const Vector3 before = seat_ + seat_rotation_ * (rotation_.transpose() * (point - position_));
  seat_ = position_;
  seat_rotation_ = rotation_;
  return point - before;
}

NearSurface PlacedContact::near_surface(const AssetView& asset,
                                        const Vector3& point) const noexcept {
  const Answer answer = query_point(asset, rotation_.transpose() * (point - position_) / scale_);
  if (answer.status != Status::exact) return {};
  const ForceSettings& force = model_.settings().force;
  // How far the probe reaches towards the surface.
  const double along = turns_ ? std::abs((rotation_ * answer.normal).dot(probe_axis_)) : 0;
  const double radius = force.probe_radius + along * force.probe_length / 2;
  return {scale_ * (answer.distance - radius), rotation_ * answer.normal,
          scale_ * (asset.band.margin - radius)};
}

/// Whether the hand may have met the box of the asset's band on its way since the last tick.
bool PlacedContact::passes(const AssetView& asset, const Vector3& point) const noexcept {
  const Extent extent = extent_of(asset);
  const Vector3& from = last_known_ ? last_ : point;
  const Vector3 low = extent.low.array() - contact_margin_;
  const Vector3 high = (extent.low + extent.size).array() + contact_margin_;
  // Written so that NaN passes, and the model answers it.
  return !((from.cwiseMax(point).array() < low.array()).any() ||
           (from.cwiseMin(point).array() > high.array()).any());
}

ContactForce PlacedContact::next(const AssetView& asset, const Vector3& point, std::uint64_t ticks,
                                 bool exact) noexcept {
  const Vector3 local = rotation_.transpose() * (point - position_) / scale_;
  if (turns_) model_.turn_probe(rotation_.transpose() * probe_axis_);
  // A proxy may still hold a hand that has left the box on the other side.
  if (may_skip_ && !touching_ && !passes(asset, local)) {
    if (!away_) model_.reset();
    away_ = last_known_ = true;
    last_ = local;
    return {};
  }
  // The model needs to know where the hand comes from.
  if (away_) static_cast<void>(model_.next(asset, last_));
  away_ = false;
  last_known_ = true;
  last_ = local;
  ContactForce contact = model_.next(asset, local, ticks, exact);
  touching_ = contact.contact;
  if (!touching_) return contact;
  contact.force = rotation_ * contact.force;
  contact.normal = rotation_ * contact.normal;
  contact.depth *= scale_;
  return contact;
}

}  // namespace spm
