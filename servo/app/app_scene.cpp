// SPDX-License-Identifier: Apache-2.0
#include "servo/app/app_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spm::servo {

namespace {

/// How long an application that moves objects may give no sign of life, s. A frame that took long,
/// or a scene that is being loaded, is not felt: the scene is held meanwhile.
constexpr double longest_silence = 1;

/// Scales that were written as decimal text may differ by rounding.
constexpr double scale_slack = 1e-9;

/// The connection that added an object; 0: the scene.
std::uint32_t owner_of(std::uint64_t id) noexcept { return static_cast<std::uint32_t>(id >> 32U); }

}  // namespace

AppScene::AppScene(AppState& state, const ForceScene& scene)
    : state_(state), added_(scene.added), own_(scene.stabilization), stabilized_(own_.any()) {
  const ForceSettings& like = scene.objects.front().force;
  added_.force.take_probe(like.probe());
  added_.force.probe_axis = like.probe_axis;
  added_.force.form = like.form;
  // What no other method knows.
  if (like.probe().paper_only()) added_.force.method = Method::paper;
  objects_.reserve(scene.objects.size() + room(scene));
  published_.reserve(SPM_MAX_OBJECTS);
  ids_.reserve(objects_.capacity());
  min_scales_.resize(assets_of(scene) + spare_assets, std::numeric_limits<double>::infinity());
  reaches_.resize(min_scales_.size(), 0);
  full_.resize(min_scales_.size(), 0);
  if (scene.tool) tool_scale_ = scene.tool->placement.scale;
  for (const PlacedObject& object : scene.objects) {
    note_scale(object);
    objects_.push_back({objects_.size(), object, PoseInterpolator({}, object.placement)});
    objects_.back().now = objects_.back().motion.at(0);
  }
  note_stiffness();
}

std::size_t AppScene::room(const ForceScene& scene) noexcept {
  return SPM_MAX_OBJECTS - std::min<std::size_t>(SPM_MAX_OBJECTS, scene.objects.size());
}

/// A smaller scale would need a larger probe than was checked for the scene.
void AppScene::note_scale(const PlacedObject& object) noexcept {
  if (object.asset >= min_scales_.size()) return;
  double& least = min_scales_[object.asset];
  least = added_.force.probe_radius > 0 ? std::min(least, object.placement.scale) : 0;
}

void AppScene::set_reach(std::size_t asset, double reach) noexcept {
  if (asset < reaches_.size()) reaches_[asset] = reach;
}

/// Whether the scene's tool, where it has one, can touch an added object: what is added follows the
/// tool's method, and the paper's knows `full` assets of one scale alone.
bool AppScene::tool_meets(std::size_t asset, double scale) const noexcept {
  if (tool_scale_ <= 0) return true;
  if (added_.force.method != Method::paper) return !is_full(asset);
  return is_full(asset) && std::abs(scale / tool_scale_ - 1) <= scale_slack;
}

/// Call it when objects were added or removed, or feel different.
void AppScene::note_stiffness() noexcept {
  stiffest_ = 0;
  for (const Object& object : objects_) {
    if (object.is_there) stiffest_ = std::max(stiffest_, object.settings.force.stiffness);
  }
}

AppScene::Object* AppScene::find(std::uint64_t id) noexcept {
  const auto found = std::find_if(objects_.begin(), objects_.end(), [id](const Object& object) {
    return object.is_there && object.id == id;
  });
  return found == objects_.end() ? nullptr : &*found;
}

AppChanges AppScene::begin(std::int64_t now_ns, std::span<SceneForce* const> forces) noexcept {
  acknowledged_ = 0;
  for (const AppCommand& command : state_.take(now_ns)) {
    const Refusal refusal = follow(command, now_ns, forces);
    if (refusal != Refusal::none) state_.refuse(command, refusal);
  }
  effects_.tell_silent([&](std::uint32_t connection, const PoseInterpolator& motion) {
    return is_left_alone(connection, motion, now_ns);
  });
  bool silent = false;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    Object& object = objects_[i];
    if (!object.is_there) continue;
    object.motion.set_reach(reach_of(object), now_ns);
    const InterpolatedPose& now = object.now = object.motion.at(now_ns);
    if (!now.driven) continue;
    silent = silent ||
             (object.motion.is_streamed() && is_left_alone(object.driver, object.motion, now_ns));
    touched_ = true;
    for (SceneForce* force : forces) force->place(i, now.pose.position, now.pose.rotation);
  }
  return {silent, touched_, stiffest_, &clutches_, &force_caps_, &hands_, acknowledged_};
}

/// How far an object's farthest place is from its origin, m, world; 0 if not known yet.
double AppScene::reach_of(const Object& object) const noexcept {
  const std::size_t asset = object.settings.asset;
  return asset < reaches_.size() ? reaches_[asset] * object.settings.placement.scale : 0;
}

void AppScene::note_drive(const AppCommand& command, std::int64_t now_ns) noexcept {
  drives_[command.client] = {command.connection, now_ns};
}

/// Whether an application that moves something hangs: it gives no sign of life; or it still reads,
/// but moves nothing any more, and what it moved was left amid its motion. One that has left is no
/// danger: what it moved stays where it is.
bool AppScene::is_left_alone(std::uint32_t connection, const PoseInterpolator& motion,
                             std::int64_t now_ns) const noexcept {
  if (connection == 0) return false;
  if (state_.silence(connection) > longest_silence) return true;
  if (!motion.ended_amid_motion()) return false;
  return std::none_of(drives_.begin(), drives_.end(), [&](const Drive& drive) {
    return drive.connection == connection &&
           static_cast<double>(now_ns - drive.at_ns) * 1e-9 <= longest_silence;
  });
}

Refusal AppScene::follow(const AppCommand& command, std::int64_t now_ns,
                         std::span<SceneForce* const> forces) noexcept {
  switch (command.action) {
    case AppAction::add:
      return add(command, forces);
    case AppAction::move:
      return move(command, now_ns);
    case AppAction::place:
      return place(command, now_ns, forces);
    case AppAction::remove:
      return remove(command, forces);
    case AppAction::material:
      return change(command, forces);
    case AppAction::clutch:
      return clutches_.set(command.index, command.on, command.connection, command.supervisor);
    case AppAction::force_cap:
      force_caps_.set(command.index, command.client, command.force_cap);
      return Refusal::none;
    case AppAction::push:
      return push(command, now_ns);
    case AppAction::effect:
      return set_effect(command, now_ns);
    case AppAction::remove_effect:
      return effects_.remove(command);
    case AppAction::acknowledge:
      if (!clutches_.allows(command.index, command.connection, command.supervisor)) {
        return Refusal::clutch_held;
      }
      acknowledged_ |= 1U << command.index;
      return Refusal::none;
    case AppAction::lead:
      return hands_.lead(command, now_ns);
    case AppAction::method:
      return set_method(command, forces);
    case AppAction::stabilize:
      return stabilize(command, forces);
    case AppAction::departure:
      depart(command, forces);
      return Refusal::none;
  }
  return Refusal::unknown_kind;
}

Refusal AppScene::add(const AppCommand& command, std::span<SceneForce* const> forces) noexcept {
  if (command.index >= min_scales_.size()) return Refusal::unknown_asset;
  if (!(command.pose.scale >= min_scales_[command.index])) return Refusal::out_of_range;
  if (!tool_meets(command.index, command.pose.scale)) return Refusal::unlike_tool;
  const bool is_own = owner_of(command.object) == command.connection;
  if (!is_own || find(command.object) != nullptr) return Refusal::not_yours;
  Object added{command.object, {}, PoseInterpolator({}, command.pose)};
  added.owner = command.connection;
  added.settings = added_;
  added.settings.asset = command.index;
  added.settings.placement = command.pose;
  added.settings.movable = true;
  set_material(command.material, added.settings);
  if (!put(added, forces)) return Refusal::too_many_objects;
  touched_ = true;
  return Refusal::none;
}

/// Adds an object. False if there is no room for it.
bool AppScene::put(const Object& added, std::span<SceneForce* const> forces) noexcept {
  std::size_t place = objects_.size();
  for (SceneForce* force : forces) {
    const auto given = force->add(added.settings);
    if (!given) return false;
    place = *given;  // the same in all of them, because all get the same calls
  }
  if (place < objects_.size()) {
    objects_[place] = added;
  } else if (objects_.size() < objects_.capacity()) {
    objects_.push_back(added);
  } else {
    return false;
  }
  objects_[place].now = added.motion.at(0);
  note_stiffness();
  return true;
}

/// An object belongs to who is the first to move or change it, until that application leaves. A
/// supervisor changes what is another's without taking it.
Refusal AppScene::take(Object& object, const AppCommand& command) noexcept {
  if (object.owner == 0 && !command.supervisor) object.owner = command.connection;
  const bool may = object.owner == command.connection || command.supervisor;
  return may ? Refusal::none : Refusal::not_yours;
}

/// Whether the application may move the object, which is taken by that.
Refusal AppScene::take_to_move(Object* object, const AppCommand& command) noexcept {
  if (object == nullptr) return Refusal::unknown_object;
  if (!object->settings.movable) return Refusal::not_movable;
  return take(*object, command);
}

Refusal AppScene::move(const AppCommand& command, std::int64_t now_ns) noexcept {
  Object* object = find(command.object);
  if (const Refusal refusal = take_to_move(object, command); refusal != Refusal::none) {
    return refusal;
  }
  object->motion.set_reach(reach_of(*object), now_ns);
  object->motion.give(command.pose, command.period, now_ns);
  note_drive(command, now_ns);
  object->driver = command.connection;
  return Refusal::none;
}

Refusal AppScene::place(const AppCommand& command, std::int64_t now_ns,
                        std::span<SceneForce* const> forces) noexcept {
  Object* object = find(command.object);
  if (const Refusal refusal = take_to_move(object, command); refusal != Refusal::none) {
    return refusal;
  }
  put_at(*object, command.pose, now_ns);
  note_drive(command, now_ns);
  object->driver = command.connection;
  hand_on(*object, forces);
  touched_ = true;
  return Refusal::none;
}

/// Puts an object to another place at once. It keeps its scale.
void AppScene::put_at(Object& object, const Placement& place, std::int64_t now_ns) noexcept {
  Placement at = place;
  at.scale = object.settings.placement.scale;
  object.motion = PoseInterpolator({}, at);
  object.now = object.motion.at(now_ns);
}

Refusal AppScene::remove(const AppCommand& command, std::span<SceneForce* const> forces) noexcept {
  Object* object = find(command.object);
  if (object == nullptr) return Refusal::unknown_object;
  const std::uint32_t owner = owner_of(command.object);
  // What is the scene's goes by an edit of the scene.
  const bool may = owner == command.connection || (command.supervisor && owner != 0);
  if (!may) return Refusal::not_yours;
  drop(place_of(*object), forces);
  return Refusal::none;
}

void AppScene::drop(std::size_t place, std::span<SceneForce* const> forces) noexcept {
  objects_[place].is_there = false;
  for (SceneForce* force : forces) force->remove(place);
  effects_.drop(place);
  note_stiffness();
}

/// A push ends by the sender's clock as well, so that one that was taken late acts no longer.
Refusal AppScene::push(const AppCommand& command, std::int64_t now_ns) noexcept {
  if (command.torque != Vector3::Zero() && !effects_.gives_torque(command.index)) {
    return Refusal::no_torque;
  }
  std::int64_t until = now_ns + static_cast<std::int64_t>(command.hold * 1e9);
  if (command.deadline_ns > 0) until = std::min(until, command.deadline_ns);
  effects_.push(command.index, command.client, {command.force, command.torque}, until);
  return Refusal::none;
}

Refusal AppScene::set_effect(const AppCommand& command, std::int64_t now_ns) noexcept {
  note_drive(command, now_ns);
  if (command.effect.kind != HandEffectKind::magnet) return effects_.set(command, 0, now_ns);
  const Object* const object = find(command.object);
  return object != nullptr ? effects_.set(command, place_of(*object), now_ns)
                           : Refusal::unknown_object;
}

void AppScene::depart(const AppCommand& departure, std::span<SceneForce* const> forces) noexcept {
  const std::uint32_t connection = departure.connection;
  clutches_.leave(connection);
  force_caps_.leave(departure.client);
  effects_.leave(departure.client, connection);
  hands_.leave(connection);
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    if (objects_[i].is_there && owner_of(objects_[i].id) == connection) drop(i, forces);
    if (objects_[i].driver == connection) objects_[i].driver = 0;
    if (objects_[i].owner == connection) objects_[i].owner = 0;
  }
}

std::size_t AppScene::free_places() const noexcept {
  const auto gone = std::count_if(objects_.begin(), objects_.end(),
                                  [](const Object& object) { return !object.is_there; });
  return objects_.capacity() - objects_.size() + static_cast<std::size_t>(gone);
}

bool AppScene::uses(std::size_t asset) const noexcept {
  return std::any_of(objects_.begin(), objects_.end(), [asset](const Object& object) {
    return object.is_there && object.settings.asset == asset;
  });
}

bool AppScene::edit(const SceneEdit& edit, std::int64_t now_ns,
                    std::span<SceneForce* const> forces) noexcept {
  if (edit.added.size() > free_places() + edit.removed.size()) return false;
  if (edit.stabilization) {
    for (SceneForce* force : forces) force->stabilize(*edit.stabilization);
    own_ = *edit.stabilization;
    stabilized_ = own_.any();
  }
  for (const std::uint64_t id : edit.removed) {
    if (const Object* object = find(id)) {
      drop(place_of(*object), forces);
    }
  }
  for (const EditedObject& edited : edit.changed) {
    Object* object = find(edited.id);
    if (object == nullptr) continue;
    object->settings = edited.settings;
    if (edited.moved) {
      put_at(*object, edited.settings.placement, now_ns);
      object->driver = 0;
    }
    note_scale(edited.settings);
    hand_on(*object, forces);
  }
  note_stiffness();
  for (const EditedObject& added : edit.added) {
    note_scale(added.settings);
    static_cast<void>(
        put({added.id, added.settings, PoseInterpolator({}, added.settings.placement)}, forces));
  }
  return true;
}

void AppScene::end(std::uint64_t tick, std::int64_t now_ns, std::span<const AppDevice> devices,
                   std::span<SceneForce* const> forces) noexcept {
  published_.clear();
  ids_.clear();
  for (const Object& object : objects_) ids_.push_back(object.id);
  for (std::size_t i = 0; i < objects_.size() && published_.size() < SPM_MAX_OBJECTS; ++i) {
    const Object& object = objects_[i];
    if (!object.is_there) continue;
    const InterpolatedPose& now = object.now;
    AppObject published;
    published.id = object.id;
    published.asset = static_cast<std::uint32_t>(object.settings.asset);
    published.pose = now.pose;
    published.pose.scale = object.settings.placement.scale;
    for (const SceneForce* force : forces) {
      published.reaction.force += force->reaction(i).force;
      published.reaction.torque += force->reaction(i).torque;
    }
    published.silent = now.silent;
    published.movable = object.settings.movable;
    published.contact = !published.reaction.force.isZero();
    published.driven = now.driven;
    published.settings = &object.settings;
    published.stabilized = stabilized_;
    published_.push_back(published);
  }
  const auto there = std::count_if(objects_.begin(), objects_.end(),
                                   [](const Object& object) { return object.is_there; });
  state_.publish({tick, now_ns, devices, published_, ids_, static_cast<std::size_t>(there)});
}

}  // namespace spm::servo
