// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "common/base/wrench.hpp"
#include "common/contact/stabilization_settings.hpp"
#include "servo/force/default_settings.hpp"
#include "servo/force/tool_settings.hpp"

namespace spm {

/// What the forces on a tool depend on beside what it touches; the hand's frame.
struct ToolLoop {
  double tick = 1e-3;        ///< s, above 0
  double encoder_step = 0;   ///< m, 0 or more
  double suitable = 1000;    ///< N/m that suits the device, where the tool names no coupling
  double stable_share = 1;   ///< what the delay leaves of the device's stable stiffness, 0 to 1
  double device_mass = 0.1;  ///< kg, above 0
  FeltLimits limits{};
  HandTurning turning{};
  double error = 0;  ///< m, certified error of the tool's surface; 0: none
};

/// How a hand holds a tool; the hand's frame, about its position.
struct ToolCoupling {
  double stiffness = 0;   ///< N/m
  double turning = 0;     ///< N m/rad
  double force_cap = 0;   ///< N, finite
  double torque_cap = 0;  ///< N m, finite; of a device without torque that of the springs alone
  bool torque = false;    ///< whether the device gives torque, and the tool's cap is not 0
};

/// Largest force that is assumed where no device tells its own, N.
inline constexpr double assumed_force_cap = worst_device_profile.force_cap;
/// The turn, rad, that the torque cap must allow before it is met: about three degrees.
inline constexpr double least_capped_turn = 0.05;

/// Of the largest force, what an error may change the force by: about what hands tell apart (5 to
/// 10 % of a force; Pang, Tan and Durlach 1991).
inline constexpr double felt_error = 0.1;

/// The coupling of a tool. What the tool does not name is chosen: the stiffness that suits the
/// device, held to what it holds stably at the delay of the loop and to what makes of the tool's
/// certified error no more than felt_error of the largest force, and that stiffness times
/// turning_lever squared. However it is named, the stiffness is at
/// most the device's limit; where the device gives torque, the turning is at most what is as stable
/// for its inertia as that limit is for its mass, and so soft that the torque cap is met at
/// least_capped_turn or later.
[[nodiscard]] ToolCoupling tool_coupling(const ToolSettings& tool, const ToolLoop& loop) noexcept;

/// Springs between a hand and its tool, as VirtualTool has them; the world's frame.
struct CoupledSprings {
  double stiffness = 0;   ///< N/m
  double turning = 0;     ///< N m/rad
  double force_cap = 0;   ///< N
  double torque_cap = 0;  ///< N m
};
/// What such springs do to a tool at a pose while the hand is at another.
struct SpringPull {
  Wrench wrench;        ///< N, and N m about the tool's position
  double energy = 0;    ///< J
  bool capped = false;  ///< a cap was met
};
[[nodiscard]] SpringPull pull_of(const CoupledSprings& springs, const Eigen::Isometry3d& tool,
                                 const Eigen::Isometry3d& hand) noexcept;

}  // namespace spm
