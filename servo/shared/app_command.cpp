// SPDX-License-Identifier: Apache-2.0
#include "servo/shared/app_command.hpp"

#include <cmath>

namespace spm::servo {

namespace {

/// Finds the first thing that is wrong with a command's numbers.
class Check {
 public:
  /// `value` must be finite and lie between two bounds, which are included.
  void number(const char* name, double value, double least, double most) noexcept {
    if (refusal_ != Refusal::none) return;
    if (!std::isfinite(value)) {
      refusal_ = Refusal::not_finite;
    } else if (value < least || value > most) {
      refusal_ = Refusal::out_of_range;
    }
    if (refusal_ != Refusal::none) wrong_ = {name, value, least, most};
  }
  void holds(bool fine, Refusal otherwise) noexcept {
    if (refusal_ == Refusal::none && !fine) refusal_ = otherwise;
  }
  [[nodiscard]] Refusal refusal() const noexcept { return refusal_; }
  [[nodiscard]] const WrongNumber& wrong() const noexcept { return wrong_; }

 private:
  Refusal refusal_ = Refusal::none;
  WrongNumber wrong_;
};

void read_pose(const spm_shared_command& from, Check& check, AppCommand& to) noexcept {
  for (const double value : from.position)
    check.number("position", value, -app_farthest, app_farthest);
  for (const double value : from.orientation) check.number("orientation", value, -2, 2);
  if (check.refusal() != Refusal::none) return;
  to.pose.position = Vector3(from.position[0], from.position[1], from.position[2]);
  to.pose.rotation = Eigen::Quaterniond(from.orientation[0], from.orientation[1],
                                        from.orientation[2], from.orientation[3]);
  check.number("length of the orientation", to.pose.rotation.norm(), 1 - app_quaternion_slack,
               1 + app_quaternion_slack);
  if (check.refusal() == Refusal::none) to.pose.rotation.normalize();
}

void read_material(const spm_shared_command& from, Check& check, AppCommand& to) noexcept {
  AppMaterial& material = to.material;
  material.given = from.fields;
  check.holds((from.fields & ~std::uint32_t{SPM_MATERIAL_ALL}) == 0, Refusal::out_of_range);
  if ((from.fields & SPM_MATERIAL_STIFFNESS) != 0) {
    check.number("stiffness", from.stiffness, 0, app_max_stiffness);
    material.stiffness = from.stiffness;
  }
  if ((from.fields & SPM_MATERIAL_FRICTION) != 0) {
    check.number("friction_stick", from.friction_stick, 0, app_max_friction);
    check.number("friction_slide", from.friction_slide, 0, app_max_friction);
    check.holds(from.friction_stick >= from.friction_slide, Refusal::out_of_range);
    material.friction_stick = from.friction_stick;
    material.friction_slide = from.friction_slide;
  }
  if ((from.fields & SPM_MATERIAL_DAMPING) != 0) {
    check.number("damping", from.damping, 0, app_max_damping);
    material.damping = from.damping;
  }
  if ((from.fields & SPM_MATERIAL_TEXTURE) != 0) {
    check.number("texture_amplitude", from.texture_amplitude, 0, app_max_amplitude);
    check.number("texture_wavelength", from.texture_wavelength, 0, app_max_wavelength);
    check.holds(from.texture_amplitude == 0 || from.texture_wavelength >= app_min_wavelength,
                Refusal::out_of_range);
    material.texture = {from.texture_amplitude, from.texture_wavelength, from.texture_seed};
  }
}

void read_add(const spm_shared_command& from, const AppCommandLimits& limits, Check& check,
              AppCommand& to) noexcept {
  to.action = AppAction::add;
  to.index = from.index;
  check.holds(from.index < limits.assets, Refusal::unknown_asset);
  read_pose(from, check, to);
  check.number("scale", from.scale, app_min_scale, app_max_scale);
  to.pose.scale = from.scale;
  read_material(from, check, to);
}

void read_move(const spm_shared_command& from, Check& check, AppCommand& to) noexcept {
  to.action = AppAction::move;
  read_pose(from, check, to);
  check.number("period", from.period, 0, app_longest_period);
  to.period = from.period;
}

void read_clutch(const spm_shared_command& from, const AppCommandLimits& limits, Check& check,
                 AppCommand& to) noexcept {
  to.action = AppAction::clutch;
  to.index = from.index;
  to.on = from.on != 0;
  check.holds(from.index < limits.devices, Refusal::unknown_device);
  check.holds(from.on <= 1, Refusal::out_of_range);
}

void read_force_cap(const spm_shared_command& from, const AppCommandLimits& limits, Check& check,
                    AppCommand& to) noexcept {
  to.action = AppAction::force_cap;
  to.index = from.index;
  check.holds(from.index < limits.devices, Refusal::unknown_device);
  check.number("force_cap", from.force_cap, 0, app_max_force_cap);
  to.force_cap = from.force_cap;
}

void read_push(const spm_shared_command& from, const AppCommandLimits& limits, Check& check,
               AppCommand& to) noexcept {
  to.action = AppAction::push;
  to.index = from.index;
  to.hold = from.hold;
  check.holds(from.index < limits.devices, Refusal::unknown_device);
  for (int axis = 0; axis < 3; ++axis) {
    check.number("force", from.force[axis], -app_max_force, app_max_force);
    check.number("torque", from.torque[axis], -app_max_torque, app_max_torque);
    to.force[axis] = from.force[axis];
    to.torque[axis] = from.torque[axis];
  }
  check.number("hold", from.hold, app_min_hold, app_max_hold);
}

void read_lead(const spm_shared_command& from, const AppCommandLimits& limits, Check& check,
               AppCommand& to) noexcept {
  read_clutch(from, limits, check, to);
  to.action = AppAction::lead;
  to.hold = from.hold;
  if (!to.on) return;
  read_pose(from, check, to);
  check.number("hold", from.hold, app_min_hold, app_max_hold);
}

void read_method(const spm_shared_command& from, Check& check, AppCommand& to) noexcept {
  to.action = AppAction::method;
  check.holds(from.index <= static_cast<std::uint32_t>(Method::proxy), Refusal::out_of_range);
  if (check.refusal() == Refusal::none) to.method = static_cast<Method>(from.index);
}

void read_stabilize(const spm_shared_command& from, Check& check, AppCommand& to) noexcept {
  to.action = AppAction::stabilize;
  to.on = from.on != 0;
  check.holds(from.on <= 1, Refusal::out_of_range);
}

/// A limit of an effect, of which 0 means none.
void read_limit(const char* name, double value, double most, Check& check, double& to) noexcept {
  check.number(name, value, 0, most);
  if (value > 0) to = value;
}

void read_axis(const spm_shared_command& from, Check& check, Vector3& to) noexcept {
  for (const double value : from.axis) check.number("axis", value, -2, 2);
  if (check.refusal() != Refusal::none) return;
  to = {from.axis[0], from.axis[1], from.axis[2]};
  check.number("length of the axis", to.norm(), 1 - app_quaternion_slack, 1 + app_quaternion_slack);
  if (check.refusal() == Refusal::none) to.normalize();
}

void read_effect(const spm_shared_command& from, const AppCommandLimits& limits, Check& check,
                 AppCommand& to) noexcept {
  to.action = AppAction::effect;
  to.index = from.index;
  to.effect_number = from.effect;
  HandEffect& effect = to.effect;
  check.holds(from.index < limits.devices, Refusal::unknown_device);
  check.holds(from.effect != SPM_ALL_EFFECTS, Refusal::out_of_range);
  check.holds(from.effect_kind >= SPM_EFFECT_SPRING && from.effect_kind <= SPM_EFFECT_DETENTS,
              Refusal::out_of_range);
  if (check.refusal() != Refusal::none) return;
  effect.kind = static_cast<HandEffectKind>(from.effect_kind - SPM_EFFECT_SPRING);
  const bool detents = effect.kind == HandEffectKind::detents;
  if (effect.kind == HandEffectKind::spring || detents) {
    for (const double value : from.position)
      check.number("position", value, -app_farthest, app_farthest);
    effect.point = {from.position[0], from.position[1], from.position[2]};
  }
  if (effect.kind == HandEffectKind::viscous) {
    check.number("damping", from.damping, 0, app_max_damping);
    effect.damping = from.damping;
  } else {
    check.number("stiffness", from.stiffness, 0, app_max_stiffness);
    effect.stiffness = from.stiffness;
  }
  read_limit("most_force", from.most_force, app_max_force, check, effect.most_force);
  read_limit("range", from.range, app_farthest, check, effect.range);
  if (!detents) return;
  read_axis(from, check, effect.axis);
  check.number("spacing", from.spacing, app_min_spacing, app_farthest);
  effect.spacing = from.spacing;
}

void read_removal(const spm_shared_command& from, const AppCommandLimits& limits, Check& check,
                  AppCommand& to) noexcept {
  to.action = AppAction::remove_effect;
  to.index = from.index;
  to.effect_number = from.effect;
  check.holds(from.index < limits.devices, Refusal::unknown_device);
}

}  // namespace

Refusal check_command(const spm_shared_command& from, const AppCommandLimits& limits,
                      AppCommand& to, WrongNumber* wrong) noexcept {
  Check check;
  to = AppCommand{};
  to.sequence = from.sequence;
  to.object = from.object;
  to.deadline_ns = from.deadline_ns;
  switch (from.kind) {
    case SPM_COMMAND_ADD:
      read_add(from, limits, check, to);
      break;
    case SPM_COMMAND_MOVE:
      read_move(from, check, to);
      break;
    case SPM_COMMAND_PLACE:
      to.action = AppAction::place;
      read_pose(from, check, to);
      break;
    case SPM_COMMAND_REMOVE:
      to.action = AppAction::remove;
      break;
    case SPM_COMMAND_MATERIAL:
      to.action = AppAction::material;
      check.holds(from.fields != 0, Refusal::nothing_given);
      read_material(from, check, to);
      break;
    case SPM_COMMAND_CLUTCH:
      read_clutch(from, limits, check, to);
      break;
    case SPM_COMMAND_FORCE_CAP:
      read_force_cap(from, limits, check, to);
      break;
    case SPM_COMMAND_PUSH:
      read_push(from, limits, check, to);
      break;
    case SPM_COMMAND_EFFECT:
      read_effect(from, limits, check, to);
      break;
    case SPM_COMMAND_REMOVE_EFFECT:
      read_removal(from, limits, check, to);
      break;
    case SPM_COMMAND_LEAD:
      read_lead(from, limits, check, to);
      break;
    case SPM_COMMAND_METHOD:
      read_method(from, check, to);
      break;
    case SPM_COMMAND_STABILIZE:
      read_stabilize(from, check, to);
      break;
    case SPM_COMMAND_ACKNOWLEDGE:
      to.action = AppAction::acknowledge;
      to.index = from.index;
      check.holds(from.index < limits.devices, Refusal::unknown_device);
      break;
    default:
      return Refusal::unknown_kind;
  }
  check.holds(from.deadline_ns <= 0 || limits.now_ns <= from.deadline_ns, Refusal::too_late);
  if (wrong != nullptr) *wrong = check.wrong();
  return check.refusal();
}

}  // namespace spm::servo
