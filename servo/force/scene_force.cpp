// SPDX-License-Identifier: Apache-2.0
#include "servo/force/scene_force.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <utility>

#include "servo/force/felt_object.hpp"

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
      blend_(tick),
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

/// N/m: the most that an object may be felt with.
double SceneForce::most_stiffness(const PlacedObject& object) const noexcept {
  if (!object.stiffness_chosen) return limits_.stiffness;
  return std::min(limits_.stiffness, limits_.stable * stable_share());
}

PlacedContact SceneForce::contact_of(const PlacedObject& object) const noexcept {
  PlacedObject capped = object;
  capped.force.probe_axis = rotation_ * object.force.probe_axis;
  const double most = most_stiffness(object);
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
  Object added{object, object, object, contact_of(object)};
  added.changed = true;
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

/// Makes an object's contact anew from what is felt of it; the hand stays on its side.
void SceneForce::remake(Object& object) noexcept {
  PlacedContact contact = contact_of(object.felt);
  contact.place_as(object.contact);
  contact.continue_from(object.contact);
  object.contact = contact;
}

void SceneForce::change(std::size_t number, const PlacedObject& settings) noexcept {
  if (number >= objects_.size()) return;
  Object& object = objects_[number];
  const Placement& place = settings.placement;
  const bool stays = place.position == object.contact.position() &&
                     place.rotation.toRotationMatrix() == object.contact.pose().linear();
  const bool other = !feels_the_same(object.settings, settings);
  const bool exchanged = settings.asset != object.settings.asset;
  if (stays && !other) {
    object.settings = settings;
    return;
  }
  if (!feels_alike(object.settings, settings)) {
    object.felt = settings;
    object.changed = true;
    object.under_way = false;
    PlacedContact contact = contact_of(settings);
    contact.continue_from(object.contact);
    object.contact = contact;
  } else if (other) {
    object.begun = object.felt;
    object.under_way = true;
  }
  if (!stays) {
    object.contact.reset();
    object.contact.place(place.position, place.rotation);
    object.changed = true;
  }
  changed_ = changed_ || (object.changed && object.touches());
  object.settings = settings;
  if (tool_ && exchanged) tool_->exchange(number);
  if (listener_ != nullptr) listener_->changed(number, settings);
}

/// Takes what is felt of the objects nearer to their settings.
void SceneForce::go_on(std::uint64_t ticks) noexcept {
  const double seconds = static_cast<double>(ticks) * tick_;
  double pressing = 0;
  for (const Object& object : objects_) {
    if (object.is_there) pressing += object.reaction.force.norm();
  }
  for (Object& object : objects_) {
    object.given = 0;
    if (!object.is_there || !object.under_way) continue;
    const double before = object.contact.stiffness();
    PlacedObject wanted = object.settings;
    const double most = most_stiffness(wanted);
    wanted.force.stiffness = std::min(wanted.force.stiffness, most);
    object.felt.force.stiffness = std::min(object.felt.force.stiffness, most);
    step_towards(object.felt, object.begun, wanted, seconds, pressing);
    // Nobody feels how an object changes that no hand is in.
    const bool unfelt = !tool_ && !object.found.contact;
    object.under_way = !unfelt && !feels_the_same(object.felt, wanted);
    if (!object.under_way) object.felt = object.settings;
    remake(object);
    object.given = 0.5 * (object.contact.stiffness() - before) * object.pressed * object.pressed;
  }
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
    changed_ = changed_ || object.touches();
    remake(object);
  }
  if (listener_ != nullptr) listener_->stabilized(stabilization);
}

void SceneForce::remove(std::size_t number) noexcept {
  if (number >= objects_.size()) return;
  Object& object = objects_[number];
  const bool touched = object.touches();
  changed_ = changed_ || touched;
  object.is_there = object.under_way = object.changed = false;
  object.reaction = {};
  object.pressed = 0;
  if (touched) stabilizer_.reset();
  if (tool_) tool_->rebalance();
  if (listener_ != nullptr) listener_->removed(number);
}

void SceneForce::place(std::size_t object, const Vector3& position,
                       const Eigen::Quaterniond& rotation) noexcept {
  if (object >= objects_.size()) return;
  objects_[object].contact.place(position, rotation);
  if (listener_ != nullptr) listener_->placed(object, position, rotation);
}

/// Ends what is under way: no hand feels it.
void SceneForce::settle() noexcept {
  stabilizer_.reset();
  std::fill(seen_.begin(), seen_.end(), 0);
  for (Object& object : objects_) {
    if (object.under_way) {
      object.felt = object.settings;
      object.under_way = false;
      remake(object);
    }
    object.reaction = {};
    object.found = {};
    object.pressed = 0;
    object.changed = false;
  }
  blend_.end();
  changed_ = felt_ = false;
}

void SceneForce::reset() noexcept {
  settle();
  if (tool_) tool_->reset();
  for (Object& object : objects_) object.contact.reset();
}

void SceneForce::rest() noexcept {
  settle();
  if (tool_) tool_->rest();
  for (Object& object : objects_) object.contact.rest();
}

ContactPatch SceneForce::touch(std::size_t number) const noexcept {
  const Object& object = objects_[number];
  return {point_ + object.pressed * object.normal, object.normal, -object.reaction.force,
          object.pressed, static_cast<std::uint32_t>(number)};
}

NearSurface SceneForce::near_surface(std::size_t object, std::span<const AssetView* const> assets,
                                     const Vector3& point) const noexcept {
  if (object >= objects_.size() || !objects_[object].is_there) return {};
  const PlacedContact& contact = objects_[object].contact;
  return contact.near_surface(*assets[contact.asset()], point);
}

void SceneForce::exchange() noexcept {
  for (Object& object : objects_) {
    object.contact.exchange();
    changed_ = changed_ || object.touches();
  }
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
    energy.carried += (share_ * object.given - object.reaction.force.dot(carried)) / scale_;
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
  const Vector3 point = point_ = position_ + scale_ * (rotation_ * hand);
  go_on(ticks);
  ask(assets, point, ticks, budget);
  ContactForce sum;
  stored_ = 0;
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
    stored_ += 0.5 * object.contact.stiffness() * contact.depth * contact.depth / scale_;
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
  stored_ *= share_;
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
  const ContactForce law =
      stabilization_.acts_on_sum() ? stabilizer_.apply(sum, hand, energy(point), ticks) : sum;
  return blended(law, {hand, Eigen::Quaterniond::Identity()}, ticks);
}

/// What was felt in the last tick, as a spring that holds the energy that was held then, as far as
/// a spring of up to twice the stiffness does.
WrenchSpring SceneForce::spring_of_last() const noexcept {
  const double touched = last_stiffness_ > 0 ? last_stiffness_ : ForceSettings{}.stiffness;
  const double stored = blend_.law_share() * stored_ + blend_.energy_at(last_hand_);
  const double holding = stored > 0 ? 0.5 * last_.force.squaredNorm() / stored : touched;
  return {last_, last_hand_, std::clamp(holding, touched, 2 * touched),
          tool_ ? tool_->coupling().turning : 0};
}

/// What a hand feels where the law gives that, so that no change of the objects makes a step.
ContactForce SceneForce::blended(const ContactForce& law, const HandPose& hand,
                                 std::uint64_t ticks) noexcept {
  for (Object& object : objects_) {
    changed_ = changed_ || (object.changed && object.touches());
    object.changed = false;
  }
  law_ = {law.force, law.torque};
  if (changed_ && felt_) {
    const WrenchSpring before = spring_of_last();
    const double seconds = static_cast<double>(ticks) * tick_;
    const bool steps = blend_.running() || differ_by_a_step(before.wrench_at(hand), law_, seconds);
    if (steps) blend_.begin(before);
  }
  changed_ = false;
  felt_ = true;
  ContactForce felt = law;
  if (blend_.running()) {
    const Wrench wrench = blend_.next(law_, hand, ticks);
    felt.force = wrench.force;
    felt.torque = wrench.torque;
  }
  last_ = {felt.force, felt.torque};
  last_hand_ = hand;
  last_stiffness_ = tool_ ? tool_->coupling().stiffness : touched_stiffness_ * scale_;
  return felt;
}

}  // namespace spm
