// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "common/base/error.hpp"
#include "servo/devices/sim/pose_motion.hpp"
#include "servo/devices/sim/sixdof_plant.hpp"
#include "servo/force/sampled_tool.hpp"
#include "servo/force/scene_force.hpp"

namespace spm::servo {

/// What a simulated hand is to do with the tool that it holds.
struct ToolTask {
  bool slide = true;  ///< if not, it presses and turns at one place
  /// m of the hand, how far below the surface it wants the tool to be; less if the object is thin
  double depth = 1e-3;
  double speed = 0.04;  ///< m/s
  std::uint64_t seed = 1;
  SixdofSettings plant;  ///< the device that the hand holds
  HandTurning turning;   ///< what the loop knows of it
  ForceScene scene;      ///< has a tool; the loop's force law acts on it
};

/// What a hand is to do, and how well it touches by a trial.
struct PlannedMotion {
  PoseMotion motion;
  double touching = -1;  ///< fraction of the ticks in contact in the worst second, 0 to 1
};

/// Plans how a hand that holds the scene's tool presses it onto the first suitable object, slides
/// and turns it there, by querying the object and by trying each plan with the simulated device and
/// the loop's force law. The first plan that stays in contact is used, or else the best one. A
/// device that does not read turns gets a motion without. `assets`: those that objects and tool
/// name. In the hand's frame. Errors: those of SampledTool::make; invalid_input, if no object has
/// any surface.
[[nodiscard]] Result<PlannedMotion> plan_tool(std::span<const AssetView* const> assets,
                                              const ToolTask& task);

/// Fraction of the ticks in contact in the worst second, 0 to 1, when the hand follows the motion
/// over the scene without the safety stage. `tool`: the samples of the scene's tool. Over `ticks`
/// ticks, rounded up to whole seconds. A motion that cannot be in contact for more than `beaten` is
/// given up as soon as that shows, and what it gives is then `beaten` at most.
[[nodiscard]] double contact_share(std::span<const AssetView* const> assets, const ToolTask& task,
                                   SampledTool& tool, PoseMotion motion, std::size_t ticks,
                                   double beaten = -1);

}  // namespace spm::servo
