// SPDX-License-Identifier: Apache-2.0
#include "common/contact/hand_effect.hpp"

#include <algorithm>
#include <cmath>

namespace spm {

namespace {

Vector3 spring_force(const HandEffect& effect, const Vector3& tool,
                     const Vector3& velocity) noexcept {
  const Vector3 way = effect.point - tool;
  const double distance = way.norm();
  Vector3 brake = -effect.damping * hold(distance, effect.range) * velocity;
  if (!(distance > 0)) return brake;
  return pull(distance, effect.stiffness, effect.range, effect.most_force) / distance * way + brake;
}

Vector3 magnet_force(const HandEffect& effect, const Vector3& velocity,
                     const NearSurface& surface) noexcept {
  // Within the surface its own contact pushes.
  if (!(surface.distance > 0)) return Vector3::Zero();
  // Beyond its band an asset knows no distance: the pull has to have ended there.
  const double range = std::min(effect.range, surface.reach);
  const double size = pull(surface.distance, effect.stiffness, range, effect.most_force);
  // At the surface the contact's own damping takes over, without a step.
  const double share = std::min(hold(surface.distance, range), 4 * surface.distance / range);
  return -(size + effect.damping * share * velocity.dot(surface.normal)) * surface.normal;
}

Vector3 detent_force(const HandEffect& effect, const Vector3& tool,
                     const Vector3& velocity) noexcept {
  const double along = effect.axis.dot(tool - effect.point);
  const double last = std::floor(effect.range / effect.spacing);
  const double nearest = std::clamp(std::round(along / effect.spacing), -last, last);
  const double off = along - nearest * effect.spacing;
  const double range = 0.5 * effect.spacing;
  const double size = pull(std::abs(off), effect.stiffness, range, effect.most_force);
  const double brake = effect.damping * hold(std::abs(off), range) * velocity.dot(effect.axis);
  return -(std::copysign(size, off) + brake) * effect.axis;
}

}  // namespace

double pull(double distance, double stiffness, double range, double most) noexcept {
  return std::max(std::min({stiffness * distance, stiffness * (range - distance), most}), 0.0);
}

double hold(double distance, double range) noexcept {
  return std::isfinite(range) ? std::clamp(4 * (1 - distance / range), 0.0, 1.0) : 1;
}

Vector3 hand_effect_force(const HandEffect& effect, const Vector3& tool, const Vector3& velocity,
                          const NearSurface& surface) noexcept {
  switch (effect.kind) {
    case HandEffectKind::spring:
      return spring_force(effect, tool, velocity);
    case HandEffectKind::viscous: {
      const Vector3 force = -effect.damping * velocity;
      const double size = force.norm();
      return size > effect.most_force ? Vector3(effect.most_force / size * force) : force;
    }
    case HandEffectKind::magnet:
      return magnet_force(effect, velocity, surface);
    case HandEffectKind::detents:
      return detent_force(effect, tool, velocity);
  }
  return Vector3::Zero();
}

}  // namespace spm
