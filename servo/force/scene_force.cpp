// SPDX-License-Identifier: Apache-2.0
#include "servo/force/scene_force.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <utility>

namespace spm {

ForceScene scene_of(const ForceSettings& force, const EffectSettings& effects) {
  return {{}, {PlacedObject{0, {}, force, effects}}, {}};
}

const ToolSettings* tool_of(const ForceScene& scene, std::size_t hand) noexcept {
  if (!scene.tool) return nullptr;
  if (hand == 0 || scene.more_tools.empty()) return &*scene.tool;
  return hand <= scene.more_tools.size() ? &scene.more_tools[hand - 1] : nullptr;
}

bool is_tool(const ForceScene& scene, std::size_t asset) noexcept {
  for (std::size_t k = 0; k < tools_of(scene); ++k) {
    if (tool_of(scene, k)->asset == asset) return true;
  }
  return false;
}

ForceScene scene_of_hand(ForceScene scene, std::size_t hand) {
  const ToolSettings* own = tool_of(scene, hand);
  scene.tool = own != nullptr ? std::optional(*own) : std::nullopt;
  scene.more_tools.clear();
  return scene;
}

SceneForce::SceneForce(const ForceScene& scene, double tick, double encoder_step, std::size_t room,
                       const FeltLimits& limits, const HandTurning& turning,
                       std::size_t hand_number)
    : rotation_(scene.workspace.rotation.toRotationMatrix()),
      position_(scene.workspace.position),
      scale_(scene.workspace.scale),
      tick_(tick),
      encoder_step_(encoder_step * scale_),
      limits_{limits.stiffness / scale_, limits.damping / scale_, limits.stable / scale_},
      stabilization_(scene.stabilization),
      asked_delay_(scene.stabilization.delay_ticks),
      stabilizer_(scene.stabilization, tick, encoder_step),
      hand_number_(hand_number) {
  objects_.reserve(scene.objects.size() + room);
  if (const ToolSettings* held = tool_of(scene, hand_number)) {
    const ToolLoop loop{tick,
                        encoder_step,
                        scene.added.force.stiffness,
                        stable_share(),
                        scene.stabilization.device_mass,
                        limits,
                        turning};
    make_tools(scene);
    tool_.emplace(*held, loop, scene.stabilization, scene.workspace, objects_.capacity(),
                  tools_.size(), hand_number);
  }
  for (const PlacedObject& object : scene.objects) static_cast<void>(add(object));
}

PlacedContact SceneForce::contact_of(const PlacedObject& object) const noexcept {
  PlacedObject capped = object;
  capped.force.probe_axis = rotation_ * object.force.probe_axis;
  double most = limits_.stiffness;
  if (object.stiffness_chosen) {
    most = std::min(most, limits_.stable * stable_share());
  }
  capped.force.stiffness = std::min(object.force.stiffness, most);
  FrictionSettings& friction = capped.effects.friction;
  friction.stiffness = std::min(friction.stiffness, most);
  capped.effects.damping = std::min(capped.effects.damping, limits_.damping);
  // A force that was turned is no gradient of a potential.
  if (stabilization_.potential > 0) capped.effects.turn.rate = 0;
  const CouplingSettings coupling{stabilization_.coupling / scale_,
                                  stabilization_.coupling_damping / scale_};
  return PlacedContact(capped, tick_, encoder_step_, coupling, stabilization_.velocity,
                       stabilization_.potential * scale_);
}

std::optional<std::size_t> SceneForce::add(const PlacedObject& object) noexcept {
  const std::optional<std::size_t> number = put(object);
  if (number && listener_ != nullptr) listener_->added(*number, object);
  return number;
}

std::optional<std::size_t> SceneForce::put(const PlacedObject& object) noexcept {
  Object added{object, contact_of(object), true, {}, {}};
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    if (objects_[i].is_there) continue;
    objects_[i] = std::move(added);
    if (tool_) tool_->exchange(i);
    return i;
  }
  // A further object would allocate.
  if (objects_.size() == objects_.capacity()) return std::nullopt;
  objects_.push_back(std::move(added));
  return objects_.size() - 1;
}

void SceneForce::change(std::size_t object, const PlacedObject& settings) noexcept {
  if (object >= objects_.size()) return;
  PlacedContact contact = contact_of(settings);
  contact.continue_from(objects_[object].contact);
  if (tool_ && settings.asset != objects_[object].settings.asset) tool_->exchange(object);
  objects_[object].settings = settings;
  objects_[object].contact = contact;
  if (listener_ != nullptr) listener_->changed(object, settings);
}

void SceneForce::set_delay(double ticks) noexcept {
  measured_delay_ = ticks;
  if (std::max(asked_delay_, ticks) == stabilization_.delay_ticks) return;
  StabilizationSettings asked = stabilization_;
  asked.delay_ticks = asked_delay_;
  stabilize(asked);
}

double SceneForce::stiffest() const noexcept {
  if (tool_) return tool_->coupling().stiffness;
  double most = 0;
  for (const Object& object : objects_) {
    if (object.is_there) most = std::max(most, object.contact.stiffness());
  }
  return most * scale_;
}

void SceneForce::stabilize(const StabilizationSettings& settings) noexcept {
  asked_delay_ = settings.delay_ticks;
  StabilizationSettings stabilization = settings;
  stabilization.delay_ticks = std::max(asked_delay_, measured_delay_);
  stabilization_ = stabilization;
  stabilizer_ = Stabilizer(stabilization, tick_, encoder_step_ / scale_);
  if (tool_) tool_->stabilize(stabilization, stable_share());
  for (Object& object : objects_) {
    PlacedContact contact = contact_of(object.settings);
    contact.place_as(object.contact);
    contact.continue_from(object.contact);
    object.contact = contact;
    object.reaction = {};
  }
  if (listener_ != nullptr) listener_->stabilized(stabilization);
}

void SceneForce::remove(std::size_t object) noexcept {
  if (object >= objects_.size()) return;
  objects_[object].is_there = false;
  objects_[object].reaction = {};
  stabilizer_.reset();
  if (tool_) tool_->rebalance();
  if (listener_ != nullptr) listener_->removed(object);
}

void SceneForce::place(std::size_t object, const Vector3& position,
                       const Eigen::Quaterniond& rotation) noexcept {
  if (object >= objects_.size()) return;
  objects_[object].contact.place(position, rotation);
  if (listener_ != nullptr) listener_->placed(object, position, rotation);
}

void SceneForce::reset() noexcept {
  stabilizer_.reset();
  if (tool_) tool_->reset();
  std::fill(seen_.begin(), seen_.end(), 0);
  for (Object& object : objects_) {
    object.contact.reset();
    object.reaction = {};
  }
}

NearSurface SceneForce::near_surface(std::size_t object, std::span<const AssetView* const> assets,
                                     const Vector3& point) const noexcept {
  if (object >= objects_.size() || !objects_[object].is_there) return {};
  const PlacedContact& contact = objects_[object].contact;
  return contact.near_surface(*assets[contact.asset()], point);
}

void SceneForce::exchange() noexcept {
  for (Object& object : objects_) object.contact.exchange();
  if (!tool_) return;
  for (std::size_t i = 0; i < tool_objects_.size(); ++i) tool_->exchange(i);
}

/// The share, up to 1, of all forces that keeps what is felt of them together within the limits.
/// An object counts by how deep it is pressed beside the deepest, so that one that is met or left
/// makes no step.
double SceneForce::share_within_limits(double deepest) const noexcept {
  Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();
  double damping = 0, most = 0;
  for (const Object& object : objects_) {
    if (!object.is_there || !(object.pressed > 0)) continue;
    const double weight = object.pressed / deepest;
    const double across = weight * object.contact.friction_stiffness();
    const double along = weight * object.contact.stiffness() - across;
    stiffness += along * object.normal * object.normal.transpose();
    stiffness.diagonal().array() += across;
    most += std::max(along + across, across);
    damping += weight * object.contact.damping();
  }
  double share = damping > limits_.damping ? limits_.damping / damping : 1;
  if (most > limits_.stiffness) {
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    const double stiffest =
        solver.computeDirect(stiffness, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
    if (stiffest > limits_.stiffness) share = std::min(share, limits_.stiffness / stiffest);
  }
  return share;
}

/// What the objects that touch a point of the world can give back, in the hand's units of length.
ContactEnergy SceneForce::energy(const Vector3& point) noexcept {
  ContactEnergy energy;
  for (Object& object : objects_) {
    if (!object.is_there) continue;
    const Vector3 carried = object.contact.carried(point);
    if (!(object.pressed > 0)) continue;
    const double stiffness = share_ * object.contact.stiffness();
    energy.stiffness += stiffness * scale_;
    energy.stored += 0.5 * stiffness * object.pressed * object.pressed / scale_;
    energy.carried -= object.reaction.force.dot(carried) / scale_;
  }
  return energy;
}

/// Asks each object for its force at a point of the world, in turn.
void SceneForce::ask(std::span<const AssetView* const> assets, const Vector3& point,
                     std::uint64_t ticks, const ForceBudget& budget) noexcept {
  const std::size_t count = objects_.size();
  if (count == 0) return;
  effort_.first = (budget.first == ForceBudget::any ? turn_ : budget.first) % count;
  bool exact = true;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t number = (effort_.first + k) % count;
    Object& object = objects_[number];
    if (!object.is_there) continue;
    if (exact && !budget.allows(effort_.exact)) {
      exact = false;
      turn_ = number;
    }
    object.found = object.contact.next(*assets[object.contact.asset()], point, ticks, exact);
    const Care care = object.contact.care();
    effort_.exact += exact ? 1 : 0;
    effort_.held += care == Care::held ? 1 : 0;
    effort_.shortened += care == Care::shortened ? 1 : 0;
  }
}

ContactForce SceneForce::next(std::span<const AssetView* const> assets, const Vector3& hand,
                              std::uint64_t ticks, const ForceBudget& budget) noexcept {
  if (tool_) return next(assets, HandPose{hand, Eigen::Quaterniond::Identity()}, ticks, budget);
  effort_ = {};
  touched_stiffness_ = 0;
  if (!hand.allFinite()) {
    reset();
    return {};
  }
  const Vector3 point = position_ + scale_ * (rotation_ * hand);
  ask(assets, point, ticks, budget);
  ContactForce sum;
  std::size_t touching = 0;
  // By number, so that the sum does not depend on which object was asked first.
  for (Object& object : objects_) {
    if (!object.is_there) continue;
    object.reaction = {};
    object.pressed = 0;
    const ContactForce& contact = object.found;
    if (!contact.contact) continue;
    object.pressed = contact.depth;
    object.normal = contact.normal;
    ++touching;
    sum.force += contact.force;
    touched_stiffness_ += object.contact.stiffness();
    object.reaction.force = -contact.force;
    object.reaction.torque = (point - object.contact.position()).cross(-contact.force);
    if (!sum.contact || contact.depth > sum.depth) {
      sum.depth = contact.depth;
      sum.normal = contact.normal;
      sum.deep = contact.deep;
    }
    sum.contact = true;
  }
  share_ = touching > 1 && sum.depth > 0 ? share_within_limits(sum.depth) : 1;
  touched_stiffness_ *= share_;
  if (share_ < 1) {
    sum.force *= share_;
    for (Object& object : objects_) {
      object.reaction.force *= share_;
      object.reaction.torque *= share_;
    }
  }
  if (sum.contact) {
    sum.force = rotation_.transpose() * sum.force;
    sum.normal = rotation_.transpose() * sum.normal;
    // Each force is finite; their sum may not be.
    if (!sum.force.allFinite()) return {};
  }
  return stabilization_.acts_on_sum() ? stabilizer_.apply(sum, hand, energy(point), ticks) : sum;
}

}  // namespace spm
