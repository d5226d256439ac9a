// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "servo/app/app_clutches.hpp"
#include "servo/app/app_effects.hpp"
#include "servo/app/app_force_caps.hpp"
#include "servo/app/app_hands.hpp"
#include "servo/app/app_state.hpp"
#include "servo/app/pose_interpolator.hpp"
#include "servo/force/scene_force.hpp"
#include "servo/scene/scene_edit.hpp"

namespace spm::servo {

/// What applications requested in a tick, beside moving objects.
struct AppChanges {
  bool silent = false;  ///< an application that moved objects no longer answers
  /// since the loop began, an application has moved, added or changed objects
  bool touched = false;
  double stiffest = 0;  ///< N/m, of the objects that are in the scene now
  // Set by `begin`:
  const AppClutches* clutches = nullptr;     ///< which are held by applications
  const AppForceCaps* force_caps = nullptr;  ///< how far applications lowered them
  const AppHands* hands = nullptr;           ///< where applications lead them
  std::uint32_t acknowledged = 0;            ///< devices whose fault somebody acknowledged, bits
};

/// The objects of a running scene, as applications see and change them. It follows their commands,
/// moves the objects that they drive evenly and no faster than people push, and reports what the
/// hands did. Belongs to the loop. After construction nothing in it allocates, locks or makes a
/// system call.
class AppScene {
 public:
  /// `state` must outlive this. The first SPM_MAX_OBJECTS objects of a scene can be driven.
  AppScene(AppState& state, const ForceScene& scene);

  /// The number of objects that applications may add to a scene.
  [[nodiscard]] static std::size_t room(const ForceScene& scene) noexcept;

  /// Call it before a tick's devices. Follows commands, and places the objects in the forces on
  /// each hand. `forces` must be of this scene, with this room, and changed by nobody else.
  AppChanges begin(std::int64_t now_ns, std::span<SceneForce* const> forces) noexcept;

  /// Call it before a tick's devices. Takes up all of an edited scene; or none of it, and returns
  /// false, if there is no room for its objects. An object that the edit moves is at its new place
  /// at once. What the edit does not change stays as applications made it, and an object that they
  /// moved stays where it is unless its pose was edited.
  [[nodiscard]] bool edit(const SceneEdit& edit, std::int64_t now_ns,
                          std::span<SceneForce* const> forces) noexcept;

  /// Tells how far an asset's surface is at most from its origin, m, asset's frame: no place of an
  /// object moves faster than people push. Call it when an asset comes.
  void set_reach(std::size_t asset, double reach) noexcept;

  /// Tells whether an asset is `full`. Call it when an asset comes. Objects that applications feel
  /// by the paper's method, which a sparse one does not know, go back to the default.
  void set_form(std::size_t asset, bool full, std::span<SceneForce* const> forces) noexcept;

  /// Whether an object of this asset is in the scene.
  [[nodiscard]] bool uses(std::size_t asset) const noexcept;

  /// Call it after the tick's devices. Publishes the tick, with objects where `begin` put them.
  void end(std::uint64_t tick, std::int64_t now_ns, std::span<const AppDevice> devices,
           std::span<SceneForce* const> forces) noexcept;

  /// The forces and effects that applications give to the hands.
  [[nodiscard]] AppEffects& effects() noexcept { return effects_; }

  /// Which hands applications lead.
  [[nodiscard]] AppHands& hands() noexcept { return hands_; }

  /// Call it when the tick is over and its length known. Publishes the counts.
  void count(const AppLoop& loop) noexcept { state_.count(loop); }

 private:
  struct Object {
    std::uint64_t id = 0;
    PlacedObject settings;  ///< the place is the one at the start
    PoseInterpolator motion;
    InterpolatedPose now = {};  ///< in this tick
    bool is_there = true;
    /// connection that added it, or was the first to move or change it; 0: none, or one that left
    std::uint32_t owner = 0;
    std::uint32_t driver = 0;  ///< connection that gave the last pose; 0: none, or one that left
  };

  [[nodiscard]] Object* find(std::uint64_t id) noexcept;
  [[nodiscard]] static Refusal take(Object& object, const AppCommand& command) noexcept;
  [[nodiscard]] static Refusal take_to_move(Object* object, const AppCommand& command) noexcept;
  [[nodiscard]] Refusal follow(const AppCommand& command, std::int64_t now_ns,
                               std::span<SceneForce* const> forces) noexcept;
  [[nodiscard]] Refusal add(const AppCommand& command,
                            std::span<SceneForce* const> forces) noexcept;
  [[nodiscard]] Refusal move(const AppCommand& command, std::int64_t now_ns) noexcept;
  [[nodiscard]] Refusal place(const AppCommand& command, std::int64_t now_ns,
                              std::span<SceneForce* const> forces) noexcept;
  static void put_at(Object& object, const Placement& place, std::int64_t now_ns) noexcept;
  [[nodiscard]] Refusal remove(const AppCommand& command,
                               std::span<SceneForce* const> forces) noexcept;
  [[nodiscard]] Refusal change(const AppCommand& command,
                               std::span<SceneForce* const> forces) noexcept;
  [[nodiscard]] Refusal set_method(const AppCommand& command,
                                   std::span<SceneForce* const> forces) noexcept;
  [[nodiscard]] Refusal stabilize(const AppCommand& command,
                                  std::span<SceneForce* const> forces) noexcept;
  [[nodiscard]] Refusal push(const AppCommand& command, std::int64_t now_ns) noexcept;
  [[nodiscard]] Refusal set_effect(const AppCommand& command, std::int64_t now_ns) noexcept;
  void depart(const AppCommand& departure, std::span<SceneForce* const> forces) noexcept;
  [[nodiscard]] bool put(const Object& added, std::span<SceneForce* const> forces) noexcept;
  [[nodiscard]] std::size_t place_of(const Object& object) const noexcept {
    return static_cast<std::size_t>(&object - objects_.data());
  }
  static void set_material(const AppMaterial& material, PlacedObject& object) noexcept;
  void hand_on(const Object& object, std::span<SceneForce* const> forces) const noexcept;
  void drop(std::size_t place, std::span<SceneForce* const> forces) noexcept;
  [[nodiscard]] std::size_t free_places() const noexcept;
  void note_stiffness() noexcept;
  void note_scale(const PlacedObject& object) noexcept;
  [[nodiscard]] double reach_of(const Object& object) const noexcept;
  [[nodiscard]] bool is_full(std::size_t asset) const noexcept {
    return asset < full_.size() && full_[asset] != 0;
  }
  [[nodiscard]] bool tool_meets(std::size_t asset, double scale) const noexcept;
  void note_drive(const AppCommand& command, std::int64_t now_ns) noexcept;
  [[nodiscard]] bool is_left_alone(std::uint32_t connection, const PoseInterpolator& motion,
                                   std::int64_t now_ns) const noexcept;

  /// When the application at a place last moved anything.
  struct Drive {
    std::uint32_t connection = 0;
    std::int64_t at_ns = 0;
  };

  AppState& state_;
  std::array<Drive, SPM_MAX_CLIENTS> drives_{};
  PlacedObject added_;  ///< what an object of an application is, beside what it names
  /// for each asset, the smallest scale that its baked probe allows
  std::vector<double> min_scales_;
  std::vector<double> reaches_;     ///< for each asset, m, asset's frame; 0 if not known yet
  std::vector<std::uint8_t> full_;  ///< for each asset, whether it is `full`
  double tool_scale_ = 0;           ///< of the scene's tool; 0: it has none
  std::vector<Object> objects_;     ///< by the numbers that SceneForce gives
  AppClutches clutches_;
  AppForceCaps force_caps_;
  AppEffects effects_;
  AppHands hands_;
  StabilizationSettings own_;       ///< the scene's, which applications may switch off and on
  bool stabilized_;                 ///< the scene is now
  std::uint32_t acknowledged_ = 0;  ///< devices, in this tick
  bool touched_ = false;
  double stiffest_ = 0;  ///< N/m
  std::vector<AppObject> published_;
  std::vector<std::uint64_t> ids_;  ///< of `objects_`
};

}  // namespace spm::servo
