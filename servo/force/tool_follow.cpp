// SPDX-License-Identifier: Apache-2.0
// How the virtual tool follows its hand, objects that move, and what tools of other hands push.
#include <algorithm>

#include "common/base/turn_between.hpp"
#include "servo/force/pressed_part.hpp"
#include "servo/force/tool_force.hpp"

namespace spm {

namespace {

/// m: an object that moves farther in a tick has jumped; its way is not gone.
constexpr double longest_swept = 2e-3;
/// Steps of the virtual tool after each part but the last.
constexpr std::uint32_t steps_of_part = 3;
/// Ticks for which a tool counts as touched that was.
constexpr std::uint32_t touching_ticks = 3;
/// m: the way of a tick of a tool that is led. One that is deeper in another tool lies in it.
constexpr double short_step = VirtualToolSettings{}.max_step;
/// Ticks in which two tools begin to press on each other after one was led out of the other.
constexpr double soft_ticks = 200;
/// A sample that is this part of the band deep may be anywhere below it.
constexpr double band_share = 0.95;
constexpr std::uint32_t unstopped = ForceEffort::unstopped;
/// Samples that tell how a tool begins, at most.
constexpr std::uint32_t samples_of_begin = 512;
/// m: in contact that is no deeper it does not matter whether depths tell the way out.
constexpr double shallow = 4 * short_step;
/// Normals cancel where the sum of all forces is less than this part of their sizes.
constexpr double least_sum = 0.3;

}  // namespace

/// How far an object's motion since the last tick takes any place at the tool, m; 0 for a jump.
double ToolForce::way_of(const ToolObject& object, std::size_t number) const noexcept {
  const Eigen::Isometry3d& seat = seats_[number];
  if (seated_[number] == 0 || object.pose.matrix() == seat.matrix()) return 0;
  const SurfaceSamples& samples = tool_->samples();
  const Vector3 middle = pose_ * samples.centre;
  const Vector3 moved = object.pose * (seat.inverse(Eigen::Isometry) * middle) - middle;
  const Vector3 turned =
      turn_between(Eigen::Quaterniond(seat.linear()), Eigen::Quaterniond(object.pose.linear()));
  const double way = moved.norm() + turned.norm() * samples.radius;
  return way <= longest_swept + late_[number] ? way : 0;
}

/// Where an object was when it had gone a part of its way in this tick.
Eigen::Isometry3d ToolForce::on_way(const ToolObject& object, std::size_t number,
                                    double share) const noexcept {
  const bool goes = seated_[number] != 0 && (ways_[number] > 0 || number == carrier_);
  if (share >= 1 || !goes) return object.pose;
  const Eigen::Isometry3d& seat = seats_[number];
  if (share <= 0) return seat;
  Eigen::Isometry3d pose = seat;
  pose.translation() += share * (object.pose.translation() - seat.translation());
  const Eigen::Quaterniond from(seat.linear()), to(object.pose.linear());
  pose.linear() = from.slerp(share, to).normalized().toRotationMatrix();
  return pose;
}

/// Moves the objects that hold on by a part of their ways, and the virtual tool with the one that
/// it presses most, so that it does not pass through.
void ToolForce::move_on(std::span<const ToolObject> objects, double from, double to) noexcept {
  if (carrier_ < objects.size()) {
    const Eigen::Isometry3d before = on_way(objects[carrier_], carrier_, from);
    pose_ = on_way(objects[carrier_], carrier_, to) * before.inverse(Eigen::Isometry) * pose_;
    pose_.linear() = Eigen::Quaterniond(pose_.linear()).normalized().toRotationMatrix();
    virtual_->carry(pose_);
  }
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (held_[i].field != nullptr) held_[i].pose = on_way(objects[i], i, to);
  }
}

/// Which of the objects that go their ways presses the tool most now.
void ToolForce::note_carrier() noexcept {
  carrier_ = held_.size();
  double most = 0;
  for (const PressedPatch& patch : contact_->patches()) {
    if (!(ways_[patch.object] > 0) || !(patch.pressing > most)) continue;
    most = patch.pressing;
    carrier_ = patch.object;
  }
}

/// The springs between hand and virtual tool, in the world.
CoupledSprings ToolForce::springs() const noexcept {
  return {coupling_.stiffness / scale_, coupling_.turning * scale_, most_force_,
          most_force_ / coupling_.force_cap * coupling_.torque_cap * scale_};
}

/// A tick of the virtual tool among the objects. What other tools push it with are springs too: it
/// is pulled to where all of them are in balance.
VirtualToolReport ToolForce::tick_of_virtual(const Eigen::Isometry3d& device,
                                             const VirtualToolBudget& budget) noexcept {
  const CoupledSprings own = springs();
  VirtualToolSettings& settings = virtual_->settings();
  // A part of what holds this tool back may be felt; the pushes are felt whole.
  const double unshared = most_force_ / coupling_.force_cap;
  settings.stiffness = own.stiffness + unshared * push_.stiffness;
  settings.turning = own.turning + unshared * push_.turning;
  settings.max_force = own.force_cap + unshared * push_.wrench.force.norm();
  settings.max_torque = own.torque_cap + unshared * push_.wrench.torque.norm();
  if (!push_.any()) return virtual_->tick(device, held_, budget);
  const Wrench pull = pull_of(own, pose_, device).wrench;
  Eigen::Isometry3d aim = pose_;
  aim.translation() += (pull.force + unshared * push_.wrench.force) / settings.stiffness;
  const Vector3 turn = (pull.torque + unshared * push_.wrench.torque) / settings.turning;
  if (const double angle = turn.norm(); angle > 0) {
    const Eigen::Quaterniond turned =
        Eigen::AngleAxisd(angle, turn / angle) * Eigen::Quaterniond(pose_.linear());
    aim.linear() = turned.normalized().toRotationMatrix();
  }
  VirtualToolReport report = virtual_->tick(aim, held_, budget);
  const SpringPull felt = pull_of(own, report.pose, device);
  const Vector3 arm = report.pose.translation() - device.translation();
  report.wrench = {-felt.wrench.force, -felt.wrench.torque - arm.cross(felt.wrench.force)};
  report.energy = felt.energy + report.contact.sum.energy;
  report.capped = felt.capped;
  return report;
}

/// One tick of the virtual tool. False where time was over in it.
bool ToolForce::step_on(const Eigen::Isometry3d& device, std::uint32_t steps, Work& work,
                        ForceEffort& effort, VirtualToolReport& report) noexcept {
  VirtualToolBudget budget = work.budget;
  budget.refine_work = work_left(budget.refine_work, work.done);
  budget.work = work_left(budget.work, work.done);
  budget.same_objects = same_objects_;
  virtual_->settings().steps = steps;
  report = tick_of_virtual(device, budget);
  pose_ = report.pose;
  if (report.refine_stopped != unstopped && effort.refined == unstopped) {
    effort.refined = work.done + report.refine_stopped;
    work.unresolved += report.unresolved;
  }
  if (report.stopped != unstopped) effort.worked = work.done + report.stopped;
  work.done += report.worked;
  work.looks += report.looks;
  work.follows = report.near_balance || report.stopped == unstopped;
  work.level = std::min(work.level, report.contact.level);
  return report.refine_stopped == unstopped && report.stopped == unstopped;
}

/// Whether objects that went a part of their ways may go the rest in the next tick: there is one
/// that the tool might pass if it were taken along by another, and none is far behind.
bool ToolForce::may_wait(double gone) const noexcept {
  if (carrier_ < held_.size() && !(ways_[carrier_] > 0)) return false;
  bool meets_others = false;
  for (std::size_t i = 0; i < held_.size(); ++i) {
    if (held_[i].field == nullptr) continue;
    meets_others = meets_others || i != carrier_;
    if ((1 - gone) * ways_[i] > longest_swept) return false;
  }
  return meets_others;
}

/// Lets the objects go their ways, and the virtual tool follow hand and objects. Where time is over
/// the objects wait, or the tool goes the rest with the one that it presses most.
VirtualToolReport ToolForce::follow(const Eigen::Isometry3d& device,
                                    std::span<const ToolObject> objects, Work& work,
                                    ForceEffort& effort) noexcept {
  VirtualToolReport report;
  double gone = 0;
  for (std::uint32_t part = 1; part < parts_;) {
    const double share = static_cast<double>(part) / parts_;
    move_on(objects, gone, share);
    gone = share;
    const bool in_time = step_on(device, steps_of_part, work, effort, report);
    note_carrier();
    if (!in_time && may_wait(gone)) {
      gone_ = gone;
      return report;
    }
    if (!in_time) {
      move_on(objects, gone, 1);
      virtual_->carry(pose_);
      return report;
    }
    // What is that far away is not met before.
    const double clear = std::min(report.contact.clearance, longest_way_);
    part += 1 + static_cast<std::uint32_t>(clear / longest_way_ * parts_);
  }
  move_on(objects, gone, 1);
  static_cast<void>(step_on(device, VirtualToolSettings{}.steps, work, effort, report));
  return report;
}

/// The tool was put where it is, or objects were where it is.
void ToolForce::put() noexcept {
  if (!virtual_) return;
  virtual_->place(pose_);
  escape_->reset();
}

/// Whether the tool of another hand that is near is led out of something: one goes after the other,
/// or both might go the same way.
bool ToolForce::another_leads(std::span<const ToolObject> objects) const noexcept {
  for (std::size_t i = first_tool_; i < objects.size(); ++i) {
    if (objects[i].leaving && held_[i].field != nullptr) return true;
  }
  return false;
}

/// Whether it lies in the tool of another hand which is led out of it, and so stays.
bool ToolForce::waits(std::span<const ToolObject> objects) const noexcept {
  return std::any_of(contact_->patches().begin(), contact_->patches().end(),
                     [&](const PressedPatch& patch) {
                       return objects[patch.object].leaving && patch.depth > short_step;
                     });
}

/// Leads the tool out of what it lies in, or lets it stay; the hand feels the springs.
VirtualToolReport ToolForce::leave(const Eigen::Isometry3d& device,
                                   std::span<const ToolObject> objects, Work& work,
                                   ForceEffort& effort) noexcept {
  move_on(objects, 0, 1);
  // Other tools are led themselves, and what hands press with does not tell a way.
  push_ = {};
  pose_.translation() += escape_->next(pose_, held_, short_step);
  virtual_->place(pose_);
  VirtualToolReport report;
  static_cast<void>(step_on(device, 0, work, effort, report));
  if (!virtual_->emerging()) escape_->came_out();
  return report;
}

/// Whether an object holds a virtual tool, rather than that it pushes the hand's.
bool ToolForce::holds(std::size_t number, const PlacedObject& object) const noexcept {
  return object.force.method == Method::proxy || left_[number] != 0;
}

/// Whether the tool has begun, or was put, so deep in objects of method `spm` that their depths do
/// not tell the way out. Those hold a virtual tool from now on.
bool ToolForce::begins_inside(const Eigen::Isometry3d& device) noexcept {
  const SurfaceSamples& samples = tool_->samples();
  TickBudget look;
  look.finest_level = level_within(samples, samples_of_begin);
  static_cast<void>(contact_->tick(device, pushed_, look));
  contact_->keep();
  bool any = false;
  for (std::size_t i = 0; i < pushed_.size(); ++i) {
    const ContactObject& object = pushed_[i];
    if (unmet_[i] == 0 || object.field == nullptr) continue;
    Vector3 force = Vector3::Zero();
    double pressing = 0, depth = 0;
    for (const PressedPatch& patch : contact_->patches()) {
      if (patch.object != i) continue;
      force += patch.force;
      pressing += patch.pressing;
      depth = std::max(depth, patch.depth);
    }
    // No hand presses a tool deeper than its largest force does.
    const double stiffness =
        std::min(object.stiffness * pressed_part * samples.area, loop_.limits.stiffness / scale_);
    const double deepest = std::min(coupling_.force_cap / stiffness,
                                    band_share * object.scale * object.field->band.max_depth);
    const bool cancels = depth > shallow && force.norm() < least_sum * pressing;
    if (!(depth > deepest) && !cancels && !escape_->surrounds(device, object)) continue;
    left_[i] = 1;
    any = true;
  }
  for (std::uint32_t i = 0; any && i < pushed_.size(); ++i) {
    if (left_[i] != 0 && unmet_[i] != 0) contact_->forget(i);
  }
  contact_->drop();
  return any;
}

/// Takes up how the tool lies in what holds it.
void ToolForce::note_lie() noexcept {
  ToolEscape::Lie lie{false, virtual_->emerging(), 0};
  double deepest = 0;
  for (const PressedPatch& patch : contact_->patches()) {
    const ContactObject& object = held_[patch.object];
    if (object.field == nullptr) continue;
    lie.deep = lie.deep || patch.depth > band_share * object.scale * object.field->band.max_depth;
    if (!(patch.depth > deepest)) continue;
    deepest = patch.depth;
    lie.object = patch.object;
  }
  // An object that was put over it, or baked anew, shall not throw it out.
  if (lie.deep && !virtual_->emerging()) virtual_->place(pose_);
  escape_->note(lie, pose_, held_);
}

/// Whether this tool touches another one, or did a moment ago: of two that press on each other one
/// may be pushed so that it just does not.
bool ToolForce::touches(std::size_t tool) noexcept {
  Met& met = met_[tool];
  Vector3 out = Vector3::Zero();
  for (const PressedPatch& patch : contact_->patches()) {
    if (patch.object == first_tool_ + tool) out += patch.pressure;
  }
  if (!out.isZero(0)) {
    met.out = out;
    met.ticks = touching_ticks;
  } else if (met.ticks > 0) {
    --met.ticks;
  }
  return met.ticks > 0;
}

/// What this tool presses another one with, which it touches; about the virtual tool's position. In
/// balance it is what is left of the springs, of what else holds the tool, and of what others push.
Wrench ToolForce::pressed_with(std::size_t tool, std::span<const ToolPush> pushes,
                               const Eigen::Isometry3d& device) const noexcept {
  Wrench wrench = pull_of(springs(), pose_, device).wrench;
  // What hands press with; what holds the tool, as a table, only passes on what presses it there.
  Wrench meant = wrench;
  double most = 0, most_torque = 0;
  for (const PressedPatch& patch : contact_->patches()) {
    if (patch.object == first_tool_ + tool) continue;
    wrench.force += patch.force;
    wrench.torque += patch.torque;
  }
  const double share = coupling_.force_cap / most_force_;
  wrench = {share * wrench.force, share * wrench.torque};
  meant = {share * meant.force, share * meant.torque};
  const Vector3 arm = tick_.pose.translation() - pose_.translation();
  for (const ToolPush& push : pushes) {
    const Vector3 torque = push.wrench.torque + arm.cross(push.wrench.force);
    if (push.hand == tool) {
      most = push.wrench.force.norm();
      most_torque = torque.norm();
      continue;
    }
    wrench.force += push.wrench.force;
    wrench.torque += torque;
    meant.force += push.wrench.force;
    meant.torque += torque;
  }
  most = std::max(most, meant.force.norm());
  most_torque = std::max(most_torque, meant.torque.norm());
  // It does not pull. While the tool is not in balance its samples may lie far too deep.
  if (!(wrench.force.dot(met_[tool].out) < 0)) return {};
  const double force = wrench.force.norm(), torque = wrench.torque.norm();
  if (force > most) wrench.force *= most / force;
  if (torque > most_torque) wrench.torque *= most_torque / torque;
  return wrench;
}

/// Tells where a tool of another hand touches this one, as seen from this one.
void ToolForce::add_mirrored(const ToolPush& push) noexcept {
  for (const ContactPatch& patch : push.patches) {
    if (patch.object != (tool_of_device | hand_)) continue;
    ContactPatch made = patch;
    made.normal = -patch.normal;
    made.force = -patch.force;
    made.object = static_cast<std::uint32_t>(first_tool_ + push.hand);
    patches_.add(made);
  }
}

/// What this tool presses those of other hands with. Where it just does not touch one it tells what
/// that one tells.
void ToolForce::press_tools(std::span<const ToolObject> objects, std::span<const ToolPush> pushes,
                            const Eigen::Isometry3d& device) noexcept {
  for (std::size_t tool = 0; tool < met_.size(); ++tool) {
    const ToolObject& object = objects[first_tool_ + tool];
    Met& met = met_[tool];
    met.given = {};
    const bool parting = leads() || object.leaving;
    met.softly = parting ? 0 : std::min(1.0, met.softly + 1.0 / soft_ticks);
    if (object.asset == nullptr || parting || !touches(tool)) continue;
    Wrench wrench = pressed_with(tool, pushes, device);
    const Vector3 arm = pose_.translation() - object.pose.translation();
    wrench.torque += arm.cross(wrench.force);
    met.given = {met.softly * wrench.force, met.softly * wrench.torque};
  }
  for (const ToolPush& push : pushes) {
    if (met_[push.hand].ticks < touching_ticks) add_mirrored(push);
  }
}

/// Tells patches at other tools by what presses there, and by the numbers that hold outside.
void ToolForce::tell_tools() noexcept {
  for (std::size_t tool = 0; tool < met_.size(); ++tool) {
    const auto number = static_cast<std::uint32_t>(first_tool_ + tool);
    Vector3 sum = Vector3::Zero();
    for (const ContactPatch& patch : tick_.contacts()) {
      if (patch.object == number) sum += patch.force;
    }
    const double given = met_[tool].given.force.norm(), told = sum.norm();
    for (std::size_t i = 0; i < tick_.patch_count; ++i) {
      ContactPatch& patch = tick_.patches[i];
      if (patch.object != number) continue;
      if (given > 0 && told > 0) patch.force *= given / told;
      patch.object = tool_of_device | static_cast<std::uint32_t>(tool);
    }
  }
}

}  // namespace spm
