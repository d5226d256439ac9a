// SPDX-License-Identifier: Apache-2.0
#include "common/scene_force.hpp"

namespace spm {

ForceScene scene_of(const ForceSettings& force, const EffectSettings& effects) {
  return {{}, {PlacedObject{0, {}, force, effects}}};
}

SceneForce::SceneForce(const ForceScene& scene, double tick, double encoder_step)
    : rotation_(scene.workspace.rotation.toRotationMatrix()),
      position_(scene.workspace.position),
      scale_(scene.workspace.scale) {
  objects_.reserve(scene.objects.size());
  for (const PlacedObject& object : scene.objects) {
    objects_.emplace_back(object, tick, encoder_step * scale_);
  }
}

void SceneForce::reset() noexcept {
  for (PlacedContact& object : objects_) object.reset();
}

ContactForce SceneForce::next(std::span<const AssetView* const> assets,
                              const Vector3& hand) noexcept {
  if (!hand.allFinite()) {
    reset();
    return {};
  }
  const Vector3 point = position_ + scale_ * (rotation_ * hand);
  ContactForce sum;
  for (PlacedContact& object : objects_) {
    const ContactForce contact = object.next(*assets[object.asset()], point);
    if (!contact.contact) continue;
    sum.force += contact.force;
    if (!sum.contact || contact.depth > sum.depth) {
      sum.depth = contact.depth;
      sum.normal = contact.normal;
      sum.deep = contact.deep;
    }
    sum.contact = true;
  }
  if (!sum.contact) return sum;
  sum.force = rotation_.transpose() * sum.force;
  sum.normal = rotation_.transpose() * sum.normal;
  // Each is finite; their sum may not be.
  return sum.force.allFinite() ? sum : ContactForce{};
}

}  // namespace spm
