// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "servo/force/scene_force.hpp"
#include "servo/app/app_state.hpp"
#include "servo/app/pose_interpolator.hpp"
#include "servo/scene/scene_edit.hpp"

namespace spm::servo {

/// What an application asked of a device in this tick.
struct AppClutch {
  std::uint32_t device = 0;
  bool on = false;
};

/// What applications asked for in a tick, beside moving objects.
struct AppChanges {
  bool felt_anew = false;  ///< objects came or feel different: forces have to fade in again
  bool silent = false;     ///< an application that moved objects does not answer any longer
  bool touched = false;    ///< since the loop began one has moved, added or changed objects
  double stiffest = 0;     ///< N/m, of the objects that there are now
  std::span<const AppClutch> clutches;
};

/// The objects of a running scene as applications see and change them: follows their commands,
/// moves what they drive, evenly and no faster than people push, and tells what the hands did.
/// Belongs to the loop; after construction nothing in it allocates, locks or makes a system call.
class AppScene {
 public:
  /// `state` must outlive this. Of a scene's objects the first SPM_MOST_OBJECTS can be driven.
  AppScene(AppState& state, const ForceScene& scene);

  /// How many objects applications may add to a scene.
  [[nodiscard]] static std::size_t room(const ForceScene& scene) noexcept;

  /// Before a tick's devices: follows commands, and puts objects where they are now, in the forces
  /// on each hand. `forces` must be of this scene, with this room, and changed by nobody else.
  AppChanges begin(std::int64_t now_ns, std::span<SceneForce* const> forces) noexcept;

  /// Before a tick's devices: takes up an edited scene, all of it, or nothing, and gives false,
  /// where there is no room for its objects. What it moves is there at once; what it does not touch
  /// stays as applications made it, and an object that they moved stays where it is unless its pose
  /// was edited.
  [[nodiscard]] bool edit(const SceneEdit& edit, std::int64_t now_ns,
                          std::span<SceneForce* const> forces) noexcept;

  /// Whether there is an object of an asset.
  [[nodiscard]] bool uses(std::size_t asset) const noexcept;

  /// After them: publishes the tick, with objects where `begin` put them.
  void end(std::uint64_t tick, std::int64_t now_ns, std::span<const AppDevice> devices,
           std::span<SceneForce* const> forces) noexcept;

  /// Once the tick is over and its length known: tells what was counted.
  void count(const AppLoop& loop) noexcept { state_.count(loop); }

 private:
  struct Object {
    std::uint64_t id = 0;
    PlacedObject settings;  ///< the place as it was at the start
    PoseInterpolator motion;
    InterpolatedPose now = {};  ///< in this tick
    bool is_there = true;
    std::uint32_t driver = 0;  ///< connection that gave the last pose; 0: none that is there
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
  double probe_radius_;               ///< m
  std::vector<double> least_scales_;  ///< of each asset, that its baked probe allows
  std::vector<Object> objects_;       ///< by the numbers that SceneForce gives
  std::array<AppClutch, SPM_MOST_DEVICES> clutches_;
  std::size_t clutch_count_ = 0;
  bool felt_anew_ = false;
  bool touched_ = false;
  double stiffest_ = 0;  ///< N/m
  std::vector<AppObject> told_;
};

}  // namespace spm::servo
