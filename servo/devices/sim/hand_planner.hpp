// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "common/base/error.hpp"
#include "servo/devices/sim/pose_motion.hpp"
#include "servo/devices/sim/sim_plant.hpp"
#include "servo/force/scene_force.hpp"

namespace spm::servo {

/// What a simulated hand is to do on an object.
struct HandTask {
  bool slide = true;  ///< if not, it presses at one place and stays there
  /// m of the hand, how far below the surface it wants to be; less if the object is thin
  double depth = 1e-3;
  double speed = 0.04;  ///< m/s
  std::uint64_t seed = 1;
  PlantSettings plant;  ///< the device that the hand holds
  ForceScene scene;     ///< the loop's force law acts on it
};

/// Plans a hand's motion on the surface of the first suitable object of a scene, by querying the
/// object itself, before the loop starts. It finds places on the surface from outside, walks over
/// the surface, and tries each plan with the simulated device and the loop's force law. The first
/// plan that stays in contact is used, or else the best one. `assets`: those that the objects name.
/// The motion is in the hand's frame. Errors: invalid_input, if no object has any surface.
[[nodiscard]] Result<PoseMotion> plan_hand(std::span<const AssetView* const> assets,
                                           const HandTask& task);

/// Fraction of the ticks in contact in the worst second, 0 to 1, when the hand follows the motion
/// over the scene without the safety stage. Over `ticks` ticks, rounded up to whole seconds.
[[nodiscard]] double contact_share(std::span<const AssetView* const> assets, const HandTask& task,
                                   PoseMotion motion, std::size_t ticks);

}  // namespace spm::servo
