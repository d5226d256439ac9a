// SPDX-License-Identifier: Apache-2.0
#include "servo/force/tool_coupling.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/turn_between.hpp"
#include "servo/stabilize/turning_lever.hpp"

namespace spm {

namespace {

/// One spring whose force is capped; adds to energy and says whether the cap was met.
Vector3 capped_pull(double stiffness, double cap, const Vector3& stretch,
                    SpringPull& pull) noexcept {
  const double size = stretch.norm();
  if (stiffness * size <= cap) {
    pull.energy += stiffness * size * size / 2;
    return stiffness * stretch;
  }
  pull.capped = true;
  pull.energy += cap * (size - cap / stiffness / 2);
  return cap / size * stretch;
}

}  // namespace

ToolCoupling tool_coupling(const ToolSettings& tool, const ToolLoop& loop) noexcept {
  ToolCoupling made;
  made.force_cap =
      std::isfinite(loop.turning.force_cap) ? loop.turning.force_cap : assumed_force_cap;
  double chosen = std::min(loop.suitable, loop.limits.stable * loop.stable_share);
  if (loop.error > 0) chosen = std::min(chosen, felt_error * made.force_cap / loop.error);
  made.stiffness = std::min(tool.coupling > 0 ? tool.coupling : chosen, loop.limits.stiffness);
  const double per_turn = turning_lever * turning_lever;
  made.turning = tool.turning > 0 ? tool.turning : per_turn * made.stiffness;
  made.torque = loop.turning.torque_cap > 0 && tool.torque_cap > 0;
  made.torque_cap = made.torque ? loop.turning.torque_cap : made.force_cap * turning_lever;
  // Of 0 it says that no torque is sent; the tool's turn still hangs on a spring.
  if (tool.torque_cap > 0) made.torque_cap = std::min(made.torque_cap, tool.torque_cap);
  if (!std::isfinite(made.torque_cap)) made.torque_cap = made.force_cap * turning_lever;
  if (made.torque) {
    // By inertia and mass alike: what is stable depends on stiffness times tick squared over mass.
    const double stiffest = std::max(made.stiffness, loop.suitable);
    made.turning = std::min({made.turning, stiffest * loop.turning.inertia / loop.device_mass,
                             made.torque_cap / least_capped_turn});
  }
  return made;
}

SpringPull pull_of(const CoupledSprings& springs, const Eigen::Isometry3d& tool,
                   const Eigen::Isometry3d& hand) noexcept {
  SpringPull pull;
  const Vector3 stretch = hand.translation() - tool.translation();
  const Vector3 turn =
      turn_between(Eigen::Quaterniond(tool.linear()), Eigen::Quaterniond(hand.linear()));
  pull.wrench.force = capped_pull(springs.stiffness, springs.force_cap, stretch, pull);
  pull.wrench.torque = capped_pull(springs.turning, springs.torque_cap, turn, pull);
  return pull;
}

}  // namespace spm
