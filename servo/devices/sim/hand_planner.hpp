// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "common/base/error.hpp"
#include "servo/force/scene_force.hpp"
#include "servo/devices/sim/hand_motion.hpp"
#include "servo/devices/sim/sim_plant.hpp"

namespace spm::servo {

/// What a simulated hand is to do on an object.
struct HandTask {
  bool slide = true;    ///< else it presses at one place and stays
  double depth = 1e-3;  ///< m of the hand, how far below the surface it wants to be; less where it
                        ///< is thin
  double speed = 0.04;  ///< m/s
  std::uint64_t seed = 1;
  PlantSettings plant;  ///< the device that it holds
  ForceScene scene;     ///< what the loop will answer with
};

/// Plans a hand's motion on the surface of a scene's objects, the first that will do, by asking the
/// object itself, before the loop starts: finds places on the surface from outside, walks over it,
/// and tries each plan with the simulated device and the loop's force law until one stays in
/// contact, or keeps the best. `assets`: those that the objects name. The motion is in the hand's
/// frame. Errors: invalid_input, where no object shows any surface.
[[nodiscard]] Result<HandMotion> plan_hand(std::span<const AssetView* const> assets,
                                           const HandTask& task);

/// Share of the ticks in contact in the worst second when the motion is followed over the scene
/// without the safety stage, 0 to 1. Over `ticks` ticks, rounded up to whole seconds.
[[nodiscard]] double contact_share(std::span<const AssetView* const> assets, const HandTask& task,
                                   HandMotion motion, std::size_t ticks);

}  // namespace spm::servo
