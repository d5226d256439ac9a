// SPDX-License-Identifier: Apache-2.0
#include "servo/force/tool_force.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/turn_between.hpp"
#include "servo/force/kept_side.hpp"

namespace spm {

namespace {

/// Of the largest force, what objects and applications may be told whatever the hand feels.
constexpr double told_anyway = 0.02;

Vector3 capped(const Vector3& vector, double cap, bool& met) noexcept {
  const double size = vector.norm();
  if (!(size > cap)) return vector;
  met = true;
  return vector * (cap / size);
}

WrenchLoop loop_of(const ToolLoop& loop, const ToolCoupling& coupling) noexcept {
  return {loop.tick, loop.encoder_step, loop.turning.turn_step, loop.turning.inertia,
          coupling.torque};
}

}  // namespace

ToolForce::ToolForce(const ToolSettings& settings, const ToolLoop& loop,
                     const StabilizationSettings& stabilization, const Placement& workspace,
                     std::size_t objects, std::size_t tools, std::size_t hand)
    : settings_(settings),
      loop_(loop),
      stabilization_(stabilization),
      coupling_(tool_coupling(settings, loop)),
      rotation_(workspace.rotation.toRotationMatrix()),
      position_(workspace.position),
      scale_(workspace.scale),
      seat_(Eigen::Translation3d(settings.placement.position) *
            settings.placement.rotation.normalized()),
      stabilizer_(stabilization, loop_of(loop, coupling_)),
      held_(objects + tools),
      pushed_(objects + tools),
      seats_(objects + tools, Eigen::Isometry3d::Identity()),
      seated_(objects + tools, 0),
      ways_(objects + tools, 0),
      late_(objects + tools, 0),
      unmet_(objects + tools, 1),
      left_(objects + tools, 0),
      reactions_(objects + tools),
      most_force_(coupling_.force_cap),
      first_tool_(objects),
      hand_(hand),
      looks_(objects + tools),
      met_(tools),
      place_velocity_(loop.encoder_step, loop.tick, stabilization.velocity),
      turn_velocity_(loop.turning.turn_step, loop.tick, stabilization.velocity) {}

void ToolForce::take(SampledTool* tool, std::size_t hand) noexcept {
  if (tool == tool_) return;
  tool_ = tool;
  loop_.error = tool != nullptr ? tool->error() / scale_ : 0;
  if (tool_coupling(settings_, loop_).stiffness != coupling_.stiffness) {
    stabilize(stabilization_, loop_.stable_share);
  }
  const bool has_samples = tool != nullptr && tool->paper() == nullptr;
  contact_ = has_samples ? &tool->contact(hand) : nullptr;
  culling_ = has_samples ? &tool->culling(hand) : nullptr;
  virtual_.reset();
  escape_.reset();
  levels_ = {};
  if (contact_ == nullptr) return;
  contact_->forget();
  const SurfaceSamples& samples = tool_->samples();
  virtual_.emplace(*contact_, VirtualToolSettings{}, samples.centre.norm() + samples.radius);
  escape_.emplace(samples);
  put();
}

void ToolForce::stabilize(const StabilizationSettings& stabilization,
                          double stable_share) noexcept {
  stabilization_ = stabilization;
  loop_.stable_share = stable_share;
  coupling_ = tool_coupling(settings_, loop_);
  stabilizer_ = WrenchStabilizer(stabilization, loop_of(loop_, coupling_));
}

void ToolForce::forget_motion() noexcept {
  stabilizer_.reset();
  place_velocity_.reset();
  turn_velocity_.reset();
  tick_ = {};
  std::fill(reactions_.begin(), reactions_.end(), Wrench{});
  std::fill(met_.begin(), met_.end(), Met{});
  std::fill(late_.begin(), late_.end(), 0.0);
  most_force_ = coupling_.force_cap;
  levels_ = {};
  looks_.forget();
  if (contact_ != nullptr) contact_->forget();
}

void ToolForce::reset() noexcept {
  forget_motion();
  placed_ = rests_ = false;
  std::fill(seated_.begin(), seated_.end(), std::uint8_t{0});
  std::fill(unmet_.begin(), unmet_.end(), std::uint8_t{1});
  std::fill(left_.begin(), left_.end(), std::uint8_t{0});
}

void ToolForce::rest() noexcept {
  if (rests_) return;
  // What holds no virtual tool back has no sides.
  if (!placed_ || !virtual_ || virtual_->emerging() || escape_->leads()) {
    reset();
    return;
  }
  leant_on_ = first_tool_;
  double most = 0;
  for (std::size_t i = 0; i < first_tool_; ++i) {
    const double size = reactions_[i].force.norm();
    if (!(size > most)) continue;
    most = size;
    leant_on_ = i;
  }
  forget_motion();
  rests_ = true;
}

/// Whether the virtual tool may go on where it rested, to which it was moved with what it leant on:
/// not where that is gone, or went far.
bool ToolForce::stays_after_rest(std::span<const ToolObject> objects) noexcept {
  if (leant_on_ >= first_tool_) return true;
  const ToolObject& object = objects[leant_on_];
  if (object.asset == nullptr || seated_[leant_on_] == 0) return false;
  const Eigen::Isometry3d& seat = seats_[leant_on_];
  const Eigen::Isometry3d carried = object.pose * seat.inverse(Eigen::Isometry) * pose_;
  const Vector3 turn =
      turn_between(Eigen::Quaterniond(seat.linear()), Eigen::Quaterniond(object.pose.linear()));
  const double way = (carried.translation() - pose_.translation()).norm();
  if (!(way <= kept_way) || !(turn.norm() <= kept_turn)) return false;
  pose_ = carried;
  pose_.linear() = Eigen::Quaterniond(pose_.linear()).normalized().toRotationMatrix();
  return true;
}

/// The virtual tool begins where it rested, or at the hand's pose. Objects may have come to where
/// it is; it leaves those by short steps.
void ToolForce::begin(const HandPose& hand, const Eigen::Isometry3d& device,
                      std::span<const ToolObject> objects) noexcept {
  if (rests_ && !stays_after_rest(objects)) reset();
  if (!placed_) pose_ = device;
  put();
  std::fill(seated_.begin(), seated_.end(), std::uint8_t{0});
  tick_.pose = pose_ * seat_;
  orientation_ = hand.orientation;
  ++starts_;
  placed_ = true;
  rests_ = false;
}

void ToolForce::exchange(std::size_t object) noexcept {
  if (contact_ != nullptr) contact_->forget(static_cast<std::uint32_t>(object));
  if (object >= held_.size()) return;
  held_[object] = {};
  seated_[object] = 0;
  late_[object] = 0;
  unmet_[object] = 1;
  left_[object] = 0;
}

void ToolForce::meet_anew(std::size_t object) noexcept {
  exchange(object);
  met_[object - first_tool_] = {};
  put();
}

ToolPush ToolForce::push_on(std::size_t hand) const noexcept {
  return {hand_, met_[hand].given, coupling_.stiffness / scale_, coupling_.turning * scale_,
          tick_.contacts()};
}

/// Adds the pushes up. They are about the tool's frame where it was.
void ToolForce::take_pushes(std::span<const ToolPush> pushes) noexcept {
  push_ = {};
  const Vector3 arm = tick_.pose.translation() - pose_.translation();
  for (const ToolPush& push : pushes) {
    const Vector3& force = push.wrench.force;
    const Vector3 torque = push.wrench.torque + arm.cross(force);
    const double size = force.squaredNorm();
    // How fast the force falls where the tool turns goes by the square of its lever.
    const double lever2 = size > 0 ? torque.squaredNorm() / size : 0;
    push_.wrench.force += force;
    push_.wrench.torque += torque;
    push_.stiffness += push.stiffness;
    push_.turning += push.turning + push.stiffness * lever2;
  }
}

Eigen::Isometry3d ToolForce::world_pose(const HandPose& hand) const noexcept {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation_ * hand.orientation.normalized().toRotationMatrix();
  pose.translation() = position_ + scale_ * (rotation_ * hand.position);
  return pose;
}

/// The work that moving objects did, J of the world; and which of them the tool presses most.
double ToolForce::work_of(std::span<const ToolObject> objects) noexcept {
  double work = 0, most = 0;
  carrier_ = objects.size();
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const Wrench& reaction = reactions_[i];
    const double size = reaction.force.norm();
    if (objects[i].asset == nullptr || seated_[i] == 0 || !(size > 0)) continue;
    const Eigen::Isometry3d& now = objects[i].pose;
    if (now.matrix() == seats_[i].matrix()) continue;
    const Vector3 moved = now.translation() - seats_[i].translation();
    const Vector3 turned =
        turn_between(Eigen::Quaterniond(seats_[i].linear()), Eigen::Quaterniond(now.linear()));
    work -= reaction.force.dot(moved) + reaction.torque.dot(turned);
    // A tool stops at another one by itself.
    const bool carries = i < first_tool_ && holds(i, *objects[i].settings);
    if (size > most && carries) {
      most = size;
      carrier_ = i;
    }
  }
  return work;
}

/// m, that an object moved in this tick where a patch is; 0 for a jump.
Vector3 ToolForce::moved_at(const ContactPatch& patch, const ToolObject& object) const noexcept {
  const double way = ways_[patch.object];
  if (!(way > 0)) return Vector3::Zero();
  const Eigen::Isometry3d& seat = seats_[patch.object];
  const Vector3 moved = object.pose * (seat.inverse(Eigen::Isometry) * patch.place) - patch.place;
  // What it had left to go from the tick before is no motion of this one.
  return (1 - late_[patch.object] / way) * moved;
}

/// Damping of eq. 18 at the patches: each brakes how the tool's place there moves along the object,
/// by its part of the force.
void ToolForce::damp(const HandPose& hand, std::span<const ToolObject> objects, std::uint64_t ticks,
                     Felt& felt) noexcept {
  turned_ += turn_between(orientation_, hand.orientation);
  orientation_ = hand.orientation;
  place_velocity_.take(hand.position, ticks);
  turn_velocity_.take(turned_, ticks);
  if (!damps_ || tick_.patch_count == 0) return;
  const Vector3 velocity = rotation_ * (scale_ * place_velocity_.velocity());
  const Vector3 turning = rotation_ * turn_velocity_.velocity();
  const Vector3 origin = position_ + scale_ * (rotation_ * hand.position);
  const double seconds = loop_.tick * static_cast<double>(std::max<std::uint64_t>(1, ticks));
  double pressing = 0;
  for (const ContactPatch& patch : tick_.contacts()) pressing += patch.force.norm();
  for (const ContactPatch& patch : tick_.contacts()) {
    const double damping =
        std::min(objects[patch.object].settings->effects.damping, loop_.limits.damping / scale_);
    if (!(damping > 0) || !(pressing > 0)) continue;
    const Vector3 arm = patch.place - origin;
    const Vector3 carried = moved_at(patch, objects[patch.object]) / seconds;
    const Vector3 force =
        -(damping * patch.force.norm() / pressing) * (velocity + turning.cross(arm) - carried);
    felt.wrench.force += force;
    felt.wrench.torque += arm.cross(force);
  }
}

/// The part of what the samples push with that counts. While the tool has not come to where the
/// springs hold it, as in a tick without time for that, its samples lie too deep and push with far
/// more than any hand feels: kilonewtons, which an application would move its object by.
double ToolForce::share_felt(const Eigen::Isometry3d& pose, const Eigen::Isometry3d& device,
                             double share, const Wrench& felt) const noexcept {
  Wrench sum;
  for (const PressedPatch& patch : contact_->patches()) {
    sum.force += share * patch.force;
    sum.torque += share * patch.torque;
  }
  sum.torque += (pose.translation() - device.translation()).cross(sum.force);
  // A couple alone has no force, and a force through the hand no torque, but by rounding.
  const double anyway = told_anyway * coupling_.force_cap;
  const double force = std::max(felt.force.norm() + push_.wrench.force.norm(), anyway);
  const double torque =
      std::max(felt.torque.norm() + push_.wrench.torque.norm(), anyway * tool_->samples().radius);
  return share / std::max({1.0, sum.force.norm() / force, sum.torque.norm() / torque});
}

/// What the objects get back of it, and the places of contact. `felt`: what of it the hand feels.
void ToolForce::react(std::span<ToolObject> objects, const Eigen::Isometry3d& pose,
                      const Eigen::Isometry3d& device, double share, const Wrench& felt) noexcept {
  share = share_felt(pose, device, share, felt);
  for (const PressedPatch& patch : contact_->patches()) {
    Wrench& reaction = objects[patch.object].reaction;
    const Vector3 arm = pose.translation() - objects[patch.object].pose.translation();
    reaction.force -= share * patch.force;
    reaction.torque -= share * (patch.torque + arm.cross(patch.force));
    patches_.add(patch, pose, device, share);
  }
}

ContactForce ToolForce::deepest() const noexcept {
  ContactForce found;
  for (const ContactPatch& patch : tick_.contacts()) {
    if (found.depth > patch.depth) continue;
    found.depth = patch.depth;
    found.normal = patch.normal;
  }
  return found;
}

/// What the objects do to a tool of samples.
void ToolForce::touch(const Eigen::Isometry3d& device, std::span<ToolObject> objects,
                      std::span<const ToolPush> pushes, const ForceBudget& budget, Felt& felt,
                      ForceEffort& effort) noexcept {
  Work work = begin_work(budget);
  sort_out(objects, device, effort);
  if (any_unmet_ && begins_inside(device)) {
    put();
    effort.culled = 0;
    sort_out(objects, device, effort);
  }
  patches_.begin(tool_->patch_size());
  if (any_pushed_) {
    push(device, work, felt, effort);
    react(objects, device, device, 1, felt.wrench);
  }
  if (any_held_ || push_.any()) {
    const Wrench pushed = felt.wrench;
    hold(device, objects, work, felt, effort);
    const Wrench held{felt.wrench.force - pushed.force, felt.wrench.torque - pushed.torque};
    react(objects, pose_, device, coupling_.force_cap / most_force_, held);
  } else {
    pose_ = device;
    virtual_->carry(pose_);
  }
  end_work(work, effort);
  press_tools(objects, pushes, device);
  patches_.write(tick_);
}

/// Keeps where the objects are, and what the tool does to them, for the next tick.
void ToolForce::sit_down(std::span<const ToolObject> objects) noexcept {
  for (std::size_t i = 0; i < objects.size(); ++i) {
    reactions_[i] = objects[i].reaction;
    const bool goes_on = gone_ < 1 && held_[i].field != nullptr && ways_[i] > 0;
    late_[i] = goes_on ? (1 - gone_) * ways_[i] : 0;
    seats_[i] = goes_on ? on_way(objects[i], i, gone_) : objects[i].pose;
    seated_[i] = objects[i].asset != nullptr ? 1 : 0;
    if (seated_[i] != 0) unmet_[i] = 0;
  }
}

ContactForce ToolForce::next(const HandPose& hand, std::span<ToolObject> objects,
                             std::span<const ToolPush> pushes, std::uint64_t ticks,
                             const ForceBudget& budget, ForceEffort& effort) noexcept {
  const Eigen::Isometry3d device = world_pose(hand);
  tick_.patch_count = 0;
  tick_.capped = tick_.leaving = false;
  for (ToolObject& object : objects) object.reaction = {};
  if (!placed_ || rests_) begin(hand, device, objects);
  gone_ = 1;
  take_pushes(pushes);
  const double carried = work_of(objects);
  Felt felt;
  if (contact_ != nullptr) {
    touch(device, objects, pushes, budget, felt, effort);
  } else {
    pose_ = device;
    if (tool_ != nullptr) press_by_paper(device, objects, budget, felt, effort);
  }
  damp(hand, objects, ticks, felt);
  sit_down(objects);
  tick_.pose = pose_ * seat_;
  tell_tools();
  ContactForce wanted = deepest();
  wanted.contact = felt.contact;
  // Newtons stay newtons, while levers and works shrink with the workspace's scale.
  const Eigen::Matrix3d back = rotation_.transpose();
  wanted.normal = back * wanted.normal;
  const WrenchEnergy energy{felt.stiffness * scale_, felt.turning / scale_, felt.stored / scale_,
                            carried / scale_};
  const Wrench capped_wrench{
      capped(back * felt.wrench.force, coupling_.force_cap, tick_.capped),
      capped(back * felt.wrench.torque / scale_, coupling_.torque_cap, tick_.capped)};
  const Wrench sent = stabilizer_.apply(capped_wrench, wanted.contact, hand, energy, ticks);
  // Braking a hand that turns half around in a tick may take more than the device may give.
  wanted.force = capped(sent.force, coupling_.force_cap, tick_.capped);
  wanted.torque = capped(sent.torque, coupling_.torque_cap, tick_.capped);
  return wanted;
}

}  // namespace spm
