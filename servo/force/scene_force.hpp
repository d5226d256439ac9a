// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "servo/force/placed_contact.hpp"
#include "servo/force/stability_cures.hpp"
#include "common/base/wrench.hpp"

namespace spm {

/// What a hand touches: objects in a world, and where the hand's frame lies in it. Fixed while the
/// loop runs.
struct ForceScene {
  Placement workspace;                ///< of the hand's frame; its scale is of lengths alone
  std::vector<PlacedObject> objects;  ///< one or more
  CureSettings cures{};               ///< of the sum, and how the objects are touched
};

/// The scene of one object whose frame is the hand's.
[[nodiscard]] ForceScene scene_of(const ForceSettings& force, const EffectSettings& effects = {});

/// The force of all objects of a scene on one hand, tick by tick: the sum of what each gives by its
/// own settings, and on it what keeps it stable. Construction allocates; nothing else does, or
/// throws.
class SceneForce {
 public:
  /// `tick` in s, above 0; `encoder_step` in m of the hand, 0 or more. There is room for so many
  /// objects beside the scene's. `stiffness_cap`: no object is felt stiffer, N a metre of the hand,
  /// above 0, whatever its settings say.
  SceneForce(const ForceScene& scene, double tick, double encoder_step, std::size_t room = 0,
             double stiffness_cap = std::numeric_limits<double>::infinity());

  /// Force on a probe centred at `hand` in the next tick. Position, force and normal are in the
  /// hand's frame, whose metres the workspace's scale makes metres of the world; newtons stay
  /// newtons. Depth (m of the world), normal and `deep` are those of the object that is pressed
  /// deepest. `assets`: those that the objects name, none null. Never NaN: a position that is not
  /// finite gives zero, and what came before is forgotten.
  [[nodiscard]] ContactForce next(std::span<const AssetView* const> assets,
                                  const Vector3& hand) noexcept;

  /// How many objects there are, those that were removed included: each has a number below it.
  [[nodiscard]] std::size_t size() const noexcept { return objects_.size(); }
  /// Puts an object where it is from now on, m and a unit rotation; its scale stays. Objects that a
  /// hand touches move under it; one that moves into the hand pushes it.
  void place(std::size_t object, const Vector3& position,
             const Eigen::Quaterniond& rotation) noexcept;
  /// Adds an object and gives its number; nothing where there is no room for one more.
  [[nodiscard]] std::optional<std::size_t> add(const PlacedObject& object) noexcept;
  /// Gives an object other settings, its place included; what touched it is forgotten.
  void change(std::size_t object, const PlacedObject& settings) noexcept;
  /// Gives the scene other cures; what was felt is forgotten.
  void cure(const CureSettings& cures) noexcept;
  /// Takes an object away, and what it pushed with it; its number may be given to another.
  void remove(std::size_t object) noexcept;
  /// What the hand did to an object in the last tick: N, and N m about its origin; world frame.
  /// What the cures take from the hand acts on no object.
  [[nodiscard]] const Wrench& reaction(std::size_t object) const noexcept {
    return objects_[object].reaction;
  }

  /// Forgets all: at the start, and when an asset was exchanged.
  void reset() noexcept;

 private:
  struct Object {
    PlacedObject settings;  ///< as they were given; the place may be another now
    PlacedContact contact;
    bool is_there = true;
    Wrench reaction;
    double pressed = 0;  ///< m of the world, in the last tick
  };

  [[nodiscard]] PlacedContact contact_of(const PlacedObject& object) const noexcept;
  [[nodiscard]] ContactEnergy energy(const Vector3& point) noexcept;

  Eigen::Matrix3d rotation_;
  Vector3 position_;
  double scale_;
  double tick_, encoder_step_;
  double stiffness_cap_;  ///< N a metre of the world
  CureSettings cures_;
  StabilityCures cured_;         ///< the sum
  std::vector<Object> objects_;  ///< never more than it has room for
};

}  // namespace spm
