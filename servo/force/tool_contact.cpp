// SPDX-License-Identifier: Apache-2.0
// Which objects a tool meets in a tick, and what they do to it, within the tick's budget.
#include <algorithm>
#include <cmath>

#include "common/base/turn_between.hpp"
#include "servo/force/pressed_part.hpp"
#include "servo/force/tool_force.hpp"

namespace spm {

namespace {

/// m: how far one sample alone may give way to the largest force of the coupling. A plate of 0.2 mm
/// has its middle at four times that.
constexpr double gives_way = 2.4e-5;
/// m. If the virtual tool is farther from the hand than this, something holds it off.
constexpr double free_stretch = 1e-6;
/// Of the stiffness that objects ask of a coupling, the least that is told apart.
constexpr double least_share = 0.02;
/// The part of a tick's time in which finer levels are looked at for the first time; the rest is
/// for the steps of the virtual tool.
constexpr double refining_share = 0.45;
/// m: objects go their ways in parts of this length, past a tool that is near. It is the longest
/// step of the virtual tool.
constexpr double part_length = VirtualToolSettings{}.max_step;
/// Of the sum of a level, what it may have changed by where finer ones are not looked at; chosen
/// with the numbers of object_quadrature.cpp.
constexpr double level_accuracy = 0.08;
constexpr std::uint32_t unstopped = ForceEffort::unstopped;

double stiffness_along(const Eigen::Matrix3d& stiffness, const Vector3& direction) noexcept {
  const double square = direction.squaredNorm();
  return square > 0 ? direction.dot(stiffness * direction) / square : 0;
}

bool same(const ContactObject& a, const ContactObject& b) noexcept {
  return a.field == b.field && a.pose.matrix() == b.pose.matrix() && a.scale == b.scale &&
         a.stiffness == b.stiffness && a.grip == b.grip &&
         a.texture.amplitude == b.texture.amplitude &&
         a.texture.wavelength == b.texture.wavelength && a.texture.seed == b.texture.seed;
}

}  // namespace

/// An object as its own settings want it to feel.
ContactObject ToolForce::contact_object(const ToolObject& object, bool holds) const noexcept {
  const PlacedObject& settings = *object.settings;
  const SurfaceSamples& samples = tool_->samples();
  const double mean_area = samples.area / samples.levels.back().count;
  ContactObject made;
  made.field = object.asset;
  made.pose = object.pose;
  made.scale = settings.placement.scale;
  made.texture = settings.effects.texture;
  made.grip.stick = settings.effects.friction.stick;
  made.grip.slide = settings.effects.friction.slide;
  if (holds) {
    // As stiff as keeps thin parts from being passed; what is felt is the coupling.
    made.stiffness = most_force_ / gives_way / mean_area;
    made.least_area = mean_area;
  } else {
    made.stiffness = settings.force.stiffness / (pressed_part * samples.area);
    made.grip.spring =
        std::clamp(settings.effects.friction.stiffness / settings.force.stiffness, 0.01, 1.0);
  }
  return made;
}

/// Which objects hold the virtual tool, which push the hand's, and how stiffly; those that are out
/// of reach do neither.
void ToolForce::sort_out(std::span<const ToolObject> objects, const Eigen::Isometry3d& device,
                         ForceEffort& effort) noexcept {
  any_held_ = any_pushed_ = any_unmet_ = damps_ = false;
  same_objects_ = true;
  longest_way_ = 0;
  bool carrier_alone = true;
  const SurfaceSamples& samples = tool_->samples();
  // How far any place of the tool may come from where it is, in this tick.
  const Vector3 turn =
      turn_between(Eigen::Quaterniond(pose_.linear()), Eigen::Quaterniond(device.linear()));
  const double reach = (device.translation() - pose_.translation()).norm() +
                       turn.norm() * (samples.centre.norm() + samples.radius);
  for (std::size_t i = 0; i < held_.size(); ++i) {
    const ContactObject before = held_[i];
    held_[i].field = pushed_[i].field = nullptr;
    const bool there = i < objects.size() && objects[i].asset != nullptr &&
                       !objects[i].asset->full && objects[i].settings->force.stiffness > 0 &&
                       objects[i].settings->force.method != Method::paper;
    if (there) {
      const bool holding = holds(i, *objects[i].settings);
      const ContactObject made = contact_object(objects[i], holding);
      const bool moved =
          i < first_tool_ && seated_[i] != 0 && objects[i].pose.matrix() != seats_[i].matrix();
      ways_[i] = i < first_tool_ ? way_of(objects[i], i) : 0;
      if (i != carrier_ && culling_->apart(i, made, pose_, reach + ways_[i])) {
        ++effort.culled;
      } else if (holding) {
        if (moved && !(ways_[i] > 0)) put();
        held_[i] = made;
        any_held_ = true;
        longest_way_ = std::max(longest_way_, ways_[i]);
        carrier_alone = carrier_alone && i == carrier_;
      } else {
        if (moved && !(ways_[i] > 0)) unmet_[i] = 1;
        pushed_[i] = made;
        any_pushed_ = true;
        any_unmet_ = any_unmet_ || unmet_[i] != 0;
      }
      damps_ = damps_ || objects[i].settings->effects.damping > 0;
    }
    same_objects_ = same_objects_ && same(before, held_[i]);
  }
  // Both use one memory of contacts.
  same_objects_ = same_objects_ && !any_pushed_;
  parts_ = carrier_alone ? 1 : static_cast<std::uint32_t>(std::ceil(longest_way_ / part_length));
}

ToolForce::Work ToolForce::begin_work(const ForceBudget& budget) const noexcept {
  Work work;
  work.budget.refine_work = budget.refined;
  work.budget.work = budget.worked;
  work.budget.finest_level = levels_.finest();
  work.level = ToolLevels::every;
  if (budget.clock == nullptr) return work;
  const std::int64_t now = budget.clock();
  work.budget.now = budget.clock;
  work.budget.until = budget.until_ns;
  if (settings_.budget > 0) {
    work.budget.until =
        std::min(work.budget.until, now + static_cast<std::int64_t>(1e9 * settings_.budget));
  }
  const auto left = static_cast<double>(std::max<std::int64_t>(0, work.budget.until - now));
  work.budget.refine_until = now + static_cast<std::int64_t>(refining_share * left);
  return work;
}

/// The objects of method `spm`.
void ToolForce::push(const Eigen::Isometry3d& device, Work& work, Felt& felt,
                     ForceEffort& effort) noexcept {
  TickBudget look;
  look.finest_level = levels_.finest();
  look.accuracy = level_accuracy;
  look.now = work.budget.now;
  if (look.now != nullptr) {
    const std::int64_t until = any_held_ ? work.budget.refine_until : work.budget.until;
    look.nanoseconds = std::max<std::int64_t>(1, until - look.now());
  }
  look.work = work_left(work.budget.refine_work, 1);
  const ObjectContactReport report = contact_->tick(device, pushed_, look);
  contact_->keep();
  contact_->settle();
  work.done = 1 + report.worked;
  work.level = std::min(work.level, report.level);
  work.unresolved += report.unresolved;
  if (report.stopped) {
    effort.refined = work.done;
    work.budget.refine_work = work.done;
  }
  const ContactSum& sum = report.sum;
  if (sum.contacts == 0) return;
  const Wrench wrench = sum.forces();
  double asked = 0, pressing = 0;
  for (const PressedPatch& patch : contact_->patches()) {
    const ContactObject& object = pushed_[patch.object];
    asked += patch.pressing * object.stiffness * pressed_part * tool_->samples().area;
    pressing += patch.pressing;
  }
  const double along = stiffness_along(sum.stiffness.topLeftCorner<3, 3>(), wrench.force);
  const double most =
      std::min(pressing > 0 ? asked / pressing : along, loop_.limits.stiffness / scale_);
  const double share = along > most ? most / along : 1;
  felt.contact = true;
  felt.wrench.force += share * wrench.force;
  felt.wrench.torque += share * wrench.torque;
  felt.stiffness += share * along;
  felt.turning += share * stiffness_along(sum.stiffness.bottomRightCorner<3, 3>(), wrench.torque);
  felt.stored += share * sum.energy;
}

/// The objects of method `proxy`.
void ToolForce::hold(const Eigen::Isometry3d& device, std::span<const ToolObject> objects,
                     Work& work, Felt& felt, ForceEffort& effort) noexcept {
  const double stiffness = coupling_.stiffness / scale_, turning = coupling_.turning * scale_;
  const bool led = escape_->leads() || waits(objects);
  const VirtualToolReport report =
      led ? leave(device, objects, work, effort) : follow(device, objects, work, effort);
  contact_->settle();
  tick_.leaving = led || virtual_->emerging();
  if (!led && !another_leads(objects)) note_lie();
  tick_.capped = tick_.capped || report.capped;
  const bool held = report.wrench.force.norm() > free_stretch * stiffness;
  if (report.contact.sum.contacts == 0 && !held && !push_.any()) {
    if (!escape_->leads()) std::fill(left_.begin(), left_.end(), std::uint8_t{0});
    most_force_ = coupling_.force_cap;
    return;
  }
  // What is felt is at most as stiff as what is touched.
  double share = push_.wrench.force.norm(), pressing = share;
  for (const PressedPatch& patch : contact_->patches()) {
    // Tools are rigid for one another.
    const double asked =
        patch.object < first_tool_ ? objects[patch.object].settings->force.stiffness : stiffness;
    share += patch.pressing * std::clamp(asked / stiffness, least_share, 1.0);
    pressing += patch.pressing;
  }
  // Rounding of a share of one would make the contact another in each tick.
  share = pressing > 0 ? std::min(1.0, share / pressing * (1 + 1e-12))
                       : coupling_.force_cap / most_force_;
  most_force_ = coupling_.force_cap / share;
  felt.contact = true;
  felt.wrench.force += share * report.wrench.force;
  felt.wrench.torque += share * report.wrench.torque;
  felt.stiffness += share * stiffness;
  felt.turning += share * turning;
  felt.stored += share * report.energy;
}

/// Tells how coarse the tick was, and how fine the next may be.
void ToolForce::end_work(const Work& work, ForceEffort& effort) noexcept {
  const auto finest = static_cast<std::uint32_t>(tool_->samples().levels.size()) - 1;
  const std::uint32_t level = std::min(work.level, finest);
  effort.level = finest - level;
  levels_.note({.looks_late = effort.refined != unstopped,
                .steps_late = effort.worked != unstopped && !work.follows,
                .level = level,
                .worked = work.done,
                .looks = work.looks,
                .unresolved = work.unresolved},
               finest);
}

}  // namespace spm
