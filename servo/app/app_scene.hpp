// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "servo/app/app_state.hpp"
#include "servo/app/pose_interpolator.hpp"
#include "servo/force/scene_force.hpp"
#include "servo/scene/scene_edit.hpp"

namespace spm::servo {

/// A request of an application for a device's clutch in this tick.
struct AppClutch {
  std::uint32_t device = 0;
  bool on = false;
};

/// What applications requested in a tick, beside moving objects.
struct AppChanges {
  bool felt_anew = false;  ///< objects were added or feel different: forces have to fade in again
  bool silent = false;     ///< an application that moved objects no longer answers
  /// since the loop began, an application has moved, added or changed objects
  bool touched = false;
  double stiffest = 0;  ///< N/m, of the objects that are in the scene now
  std::span<const AppClutch> clutches;
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

  /// Whether an object of this asset is in the scene.
  [[nodiscard]] bool uses(std::size_t asset) const noexcept;

  /// Call it after the tick's devices. Publishes the tick, with objects where `begin` put them.
  void end(std::uint64_t tick, std::int64_t now_ns, std::span<const AppDevice> devices,
           std::span<SceneForce* const> forces) noexcept;

  /// Call it when the tick is over and its length known. Publishes the counts.
  void count(const AppLoop& loop) noexcept { state_.count(loop); }

 private:
  struct Object {
    std::uint64_t id = 0;
    PlacedObject settings;  ///< the place is the one at the start
    PoseInterpolator motion;
    InterpolatedPose now = {};  ///< in this tick
    bool is_there = true;
    std::uint32_t driver = 0;  ///< connection that gave the last pose; 0: none, or one that left
  };

  [[nodiscard]] Object* find(std::uint64_t id) noexcept;
  [[nodiscard]] Refusal follow(const AppCommand& command, std::int64_t now_ns,
                               std::span<SceneForce* const> forces) noexcept;
  [[nodiscard]] Refusal add(const AppCommand& command,
                            std::span<SceneForce* const> forces) noexcept;
  [[nodiscard]] Refusal move(const AppCommand& command, std::int64_t now_ns) noexcept;
  [[nodiscard]] Refusal remove(const AppCommand& command,
                               std::span<SceneForce* const> forces) noexcept;
  [[nodiscard]] Refusal change(const AppCommand& command, std::int64_t now_ns,
                               std::span<SceneForce* const> forces) noexcept;
  void depart(std::uint32_t connection, std::span<SceneForce* const> forces) noexcept;
  [[nodiscard]] bool put(const Object& added, std::span<SceneForce* const> forces) noexcept;
  [[nodiscard]] std::size_t place_of(const Object& object) const noexcept {
    return static_cast<std::size_t>(&object - objects_.data());
  }
  void hand_on(const Object& object, std::int64_t now_ns,
               std::span<SceneForce* const> forces) const noexcept;
  void drop(std::size_t place, std::span<SceneForce* const> forces) noexcept;
  [[nodiscard]] std::size_t free_places() const noexcept;
  void note_stiffness() noexcept;
  void note_scale(const PlacedObject& object) noexcept;
  [[nodiscard]] bool is_left_alone(const Object& object) const noexcept;

  AppState& state_;
  double probe_radius_;  ///< m
  /// for each asset, the smallest scale that its baked probe allows
  std::vector<double> min_scales_;
  std::vector<Object> objects_;  ///< by the numbers that SceneForce gives
  std::array<AppClutch, SPM_MAX_DEVICES> clutches_;
  std::size_t clutch_count_ = 0;
  bool felt_anew_ = false;
  bool touched_ = false;
  double stiffest_ = 0;  ///< N/m
  std::vector<AppObject> published_;
};

}  // namespace spm::servo
