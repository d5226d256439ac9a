// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/placed_contact.hpp"

namespace spm {

/// What a hand touches: objects in a world, and where the hand's frame lies in it. Fixed while the
/// loop runs.
struct ForceScene {
  Placement workspace;                ///< of the hand's frame; its scale is of lengths alone
  std::vector<PlacedObject> objects;  ///< one or more
};

/// The scene of one object whose frame is the hand's.
[[nodiscard]] ForceScene scene_of(const ForceSettings& force, const EffectSettings& effects = {});

/// The force of all objects of a scene on one hand, tick by tick: the sum of what each gives by its
/// own settings. Construction allocates; nothing else does, or throws.
class SceneForce {
 public:
  /// `tick` in s, above 0; `encoder_step` in m of the hand, 0 or more.
  SceneForce(const ForceScene& scene, double tick, double encoder_step);

  /// Force on a probe centred at `hand` in the next tick. Position, force and normal are in the
  /// hand's frame, whose metres the workspace's scale makes metres of the world; newtons stay
  /// newtons. Depth (m of the world), normal and `deep` are those of the object that is pressed
  /// deepest. `assets`: those that the objects name, none null. Never NaN: a position that is not
  /// finite gives zero, and what came before is forgotten.
  [[nodiscard]] ContactForce next(std::span<const AssetView* const> assets,
                                  const Vector3& hand) noexcept;

  /// Forgets all: at the start, and when an asset was exchanged.
  void reset() noexcept;

 private:
  Eigen::Matrix3d rotation_;
  Vector3 position_;
  double scale_;
  std::vector<PlacedContact> objects_;
};

}  // namespace spm
