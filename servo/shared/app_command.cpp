// SPDX-License-Identifier: Apache-2.0
#include "servo/shared/app_command.hpp"

#include <cmath>

namespace spm::servo {

namespace {

/// Finds the first thing that is wrong with a command's numbers.
class Check {
 public:
  /// `value` must be finite and lie between two bounds, which are included.
  void number(double value, double least, double most) noexcept {
    if (refusal_ != Refusal::none) return;
    if (!std::isfinite(value)) {
      refusal_ = Refusal::not_finite;
    } else if (value < least || value > most) {
      refusal_ = Refusal::out_of_range;
    }
  }
  void holds(bool fine, Refusal otherwise) noexcept {
    if (refusal_ == Refusal::none && !fine) refusal_ = otherwise;
  }
  [[nodiscard]] Refusal refusal() const noexcept { return refusal_; }

 private:
  Refusal refusal_ = Refusal::none;
};

void read_pose(const spm_shared_command& from, Check& check, AppCommand& to) noexcept {
  for (const double value : from.position) check.number(value, -app_farthest, app_farthest);
  for (const double value : from.orientation) check.number(value, -2, 2);
  if (check.refusal() != Refusal::none) return;
  to.pose.position = Vector3(from.position[0], from.position[1], from.position[2]);
  to.pose.rotation = Eigen::Quaterniond(from.orientation[0], from.orientation[1],
                                        from.orientation[2], from.orientation[3]);
  check.number(to.pose.rotation.norm(), 1 - app_quaternion_slack, 1 + app_quaternion_slack);
  if (check.refusal() == Refusal::none) to.pose.rotation.normalize();
}

void read_material(const spm_shared_command& from, Check& check, AppCommand& to) noexcept {
  AppMaterial& material = to.material;
  material.given = from.fields;
  check.holds((from.fields & ~std::uint32_t{SPM_MATERIAL_ALL}) == 0, Refusal::out_of_range);
  if ((from.fields & SPM_MATERIAL_STIFFNESS) != 0) {
    check.number(from.stiffness, 0, app_max_stiffness);
    material.stiffness = from.stiffness;
  }
  if ((from.fields & SPM_MATERIAL_FRICTION) != 0) {
    check.number(from.friction_stick, 0, app_max_friction);
    check.number(from.friction_slide, 0, app_max_friction);
    check.holds(from.friction_stick >= from.friction_slide, Refusal::out_of_range);
    material.friction_stick = from.friction_stick;
    material.friction_slide = from.friction_slide;
  }
  if ((from.fields & SPM_MATERIAL_DAMPING) != 0) {
    check.number(from.damping, 0, app_max_damping);
    material.damping = from.damping;
  }
  if ((from.fields & SPM_MATERIAL_TEXTURE) != 0) {
    check.number(from.texture_amplitude, 0, app_max_amplitude);
    check.number(from.texture_wavelength, 0, app_max_wavelength);
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
  check.number(from.scale, app_min_scale, app_max_scale);
  to.pose.scale = from.scale;
  read_material(from, check, to);
}

void read_move(const spm_shared_command& from, Check& check, AppCommand& to) noexcept {
  to.action = AppAction::move;
  read_pose(from, check, to);
  check.number(from.period, 0, app_longest_period);
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
  check.number(from.force_cap, 0, app_max_force_cap);
  to.force_cap = from.force_cap;
}

}  // namespace

Refusal check_command(const spm_shared_command& from, const AppCommandLimits& limits,
                      AppCommand& to) noexcept {
  Check check;
  to = AppCommand{};
  to.sequence = from.sequence;
  to.object = from.object;
  switch (from.kind) {
    case SPM_COMMAND_ADD:
      read_add(from, limits, check, to);
      break;
    case SPM_COMMAND_MOVE:
      read_move(from, check, to);
      break;
    case SPM_COMMAND_REMOVE:
      to.action = AppAction::remove;
      break;
    case SPM_COMMAND_MATERIAL:
      to.action = AppAction::material;
      read_material(from, check, to);
      break;
    case SPM_COMMAND_CLUTCH:
      read_clutch(from, limits, check, to);
      break;
    case SPM_COMMAND_FORCE_CAP:
      read_force_cap(from, limits, check, to);
      break;
    default:
      return Refusal::unknown_kind;
  }
  check.holds(from.deadline_ns <= 0 || limits.now_ns <= from.deadline_ns, Refusal::too_late);
  return check.refusal();
}

}  // namespace spm::servo
