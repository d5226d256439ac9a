// SPDX-License-Identifier: Apache-2.0
// AppScene: how its objects feel, and by which method.
#include "common/contact/method_mismatch.hpp"
#include "servo/app/app_scene.hpp"
#include "servo/force/default_settings.hpp"

namespace spm::servo {

void AppScene::set_material(const AppMaterial& material, PlacedObject& object) noexcept {
  if ((material.given & SPM_MATERIAL_STIFFNESS) != 0) {
    object.force.stiffness = material.stiffness;
    object.stiffness_chosen = false;
  }
  if ((material.given & SPM_MATERIAL_FRICTION) != 0) {
    object.effects.friction.stick = material.friction_stick;
    object.effects.friction.slide = material.friction_slide;
    // If a scene says nothing else, a point that sticks is held by the object's own stiffness.
    if (object.effects.friction.stiffness <= 0) {
      object.effects.friction.stiffness = object.force.stiffness;
    }
  }
  if ((material.given & SPM_MATERIAL_DAMPING) != 0) object.effects.damping = material.damping;
  if ((material.given & SPM_MATERIAL_TEXTURE) != 0) object.effects.texture = material.texture;
}

void AppScene::set_form(std::size_t asset, bool full,
                        std::span<SceneForce* const> forces) noexcept {
  if (asset < full_.size()) full_[asset] = full ? 1 : 0;
  if (full) return;
  for (Object& object : objects_) {
    Method& method = object.settings.force.method;
    if (!object.is_there || object.settings.asset != asset || method != Method::paper) continue;
    method = default_method;
    hand_on(object, forces);
  }
}

Refusal AppScene::change(const AppCommand& command, std::span<SceneForce* const> forces) noexcept {
  Object* object = find(command.object);
  if (object == nullptr) return Refusal::unknown_object;
  // The paper's method has other effects.
  if (object->settings.force.method == Method::paper &&
      (command.material.given & ~std::uint32_t{SPM_MATERIAL_STIFFNESS}) != 0) {
    return Refusal::out_of_range;
  }
  if (const Refusal refusal = take(*object, command); refusal != Refusal::none) return refusal;
  set_material(command.material, object->settings);
  hand_on(*object, forces);
  note_stiffness();
  touched_ = true;
  return Refusal::none;
}

/// A tool is of one form, which what it meets has to suit.
Refusal AppScene::set_method(const AppCommand& command,
                             std::span<SceneForce* const> forces) noexcept {
  Object* object = find(command.object);
  if (object == nullptr) return Refusal::unknown_object;
  ForceSettings wanted = object->settings.force;
  wanted.method = command.method;
  const bool by_paper = wanted.method == Method::paper;
  const bool was_by_paper = object->settings.force.method == Method::paper;
  if (tool_scale_ > 0 && by_paper != was_by_paper) return Refusal::unlike_tool;
  if ((by_paper && !is_full(object->settings.asset)) ||
      mismatch_of(wanted, object->settings.effects) != MethodMismatch::none) {
    return Refusal::unlike_method;
  }
  if (const Refusal refusal = take(*object, command); refusal != Refusal::none) return refusal;
  object->settings.force = wanted;
  hand_on(*object, forces);
  touched_ = true;
  return Refusal::none;
}

/// The scene's own stabilization, or what is recommended where it has none.
Refusal AppScene::stabilize(const AppCommand& command,
                            std::span<SceneForce* const> forces) noexcept {
  if (!command.supervisor) return Refusal::supervisor_only;
  const StabilizationSettings named = command.on ? default_stabilization : StabilizationSettings{};
  const StabilizationSettings wanted = command.on && own_.any() ? own_ : in_loop_of(own_, named);
  for (SceneForce* force : forces) force->stabilize(wanted);
  stabilized_ = wanted.any();
  touched_ = true;
  return Refusal::none;
}

/// Gives the forces an object's settings, where it was in the last tick: how it moves on is no
/// change of it.
void AppScene::hand_on(const Object& object, std::span<SceneForce* const> forces) const noexcept {
  PlacedObject settings = object.settings;
  const Placement& now = object.now.pose;
  settings.placement.position = now.position;
  settings.placement.rotation = now.rotation;
  for (SceneForce* force : forces) force->change(place_of(object), settings);
}

}  // namespace spm::servo
